// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/replay/scan_files.h"

#include <algorithm>
#include <utility>

namespace dubsar::replay {

namespace fs = std::filesystem;

ScanFiles::ScanFiles(std::vector<fs::path> files, GridReadOptions options)
    : files_(std::move(files)), options_(std::move(options)) {
  // Only PTX holds several scans; looking into one means reading all of it.
  const bool one_each = std::ranges::none_of(files_, [](const fs::path& file) {
    std::string extension = file.extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? c + 32 : c; });
    return extension == ".ptx";
  });
  if (one_each) {
    count_ = static_cast<std::int64_t>(files_.size());
  }
}

Result<ScanFiles> ScanFiles::open(const fs::path& path, const GridReadOptions& options) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    return bad_input(path.string(), "no such file or folder", "check the name");
  }
  if (!fs::is_directory(status)) {
    return ScanFiles({path}, options);
  }
  std::vector<fs::path> files;
  std::size_t others = 0;
  fs::directory_iterator it(path, error);
  for (const fs::directory_iterator end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    if (!it->is_regular_file(ignored) || it->path().filename().string().starts_with('.')) {
      continue;
    }
    if (looks_like_scan(it->path())) {
      files.push_back(it->path());
    } else {
      ++others;
    }
  }
  if (error) {
    return bad_input(path.string(), "the folder cannot be read: " + error.message(), "make it readable");
  }
  if (files.empty()) {
    return bad_input(path.string(),
                     others == 0 ? "the folder is empty"
                                 : "none of the " + std::to_string(others) + " files in the folder is a scan",
                     "name a folder with range grids (PLY, PTX or point files); subfolders are not searched");
  }
  std::ranges::sort(files);
  return ScanFiles(std::move(files), options);
}

Result<std::optional<ScanData>> ScanFiles::next() {
  while (waiting_.empty()) {
    if (next_file_ == files_.size()) {
      return std::optional<ScanData>();
    }
    remarks_.clear();
    options_.remark = [this](const std::string& scan, const std::string& remark) {
      remarks_.emplace_back(scan, remark);
    };
    Result<std::vector<ScanData>> scans = read_scan_file(files_[next_file_++], options_);
    if (!scans) {
      return std::unexpected(scans.error());
    }
    waiting_.assign(std::make_move_iterator(scans->begin()), std::make_move_iterator(scans->end()));
  }
  std::optional<ScanData> scan(std::move(waiting_.front()));
  waiting_.pop_front();
  return scan;
}

std::vector<std::string> ScanFiles::remarks_on(const std::string& scan) const {
  std::vector<std::string> out;
  for (const auto& [name, remark] : remarks_) {
    if (name == scan) {
      out.push_back(remark);
    }
  }
  return out;
}

}  // namespace dubsar::replay
