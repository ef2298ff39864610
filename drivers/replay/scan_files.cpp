// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/replay/scan_files.h"

#include <algorithm>
#include <utility>

namespace dubsar::replay {

namespace fs = std::filesystem;

namespace {

struct FolderContent {
  std::vector<fs::path> scans;
  std::size_t other_files = 0;
  std::vector<fs::path> subfolders;
};

FolderContent content_of(const fs::path& folder, std::error_code& error) {
  FolderContent content;
  fs::directory_iterator it(folder, error);
  for (const fs::directory_iterator end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    if (it->path().filename().string().starts_with('.')) {
      continue;
    }
    if (it->is_directory(ignored)) {
      content.subfolders.push_back(it->path());
    } else if (it->is_regular_file(ignored)) {
      if (looks_like_scan(it->path())) {
        content.scans.push_back(it->path());
      } else {
        ++content.other_files;
      }
    }
  }
  return content;
}

/// Says what is there instead, so that whoever named the folder above the scans sees which to name.
std::unexpected<Error> without_scans(const fs::path& folder, const FolderContent& content) {
  constexpr std::size_t kMostNamed = 5;
  std::vector<std::string> with_scans;
  for (const fs::path& subfolder : content.subfolders) {
    std::error_code unreadable;
    if (!content_of(subfolder, unreadable).scans.empty()) {
      with_scans.push_back(subfolder.filename().string());
    }
  }
  std::string problem = content.other_files > 0 ? "none of the " + std::to_string(content.other_files) +
                                                      " files in the folder is a scan"
                        : content.subfolders.empty() ? "the folder is empty"
                                                     : "the folder holds no files";
  const std::string of = std::to_string(content.subfolders.size());
  if (with_scans.empty()) {
    problem += content.subfolders.empty() ? "" : ", and of its subfolders (" + of + ") none holds scans";
    return bad_input(folder.string(), problem, "name a folder with range grids (PLY, PTX or point files)");
  }
  std::ranges::sort(with_scans);
  problem += ", but of its subfolders (" + of + ") these hold scans: ";
  for (std::size_t k = 0; k < std::min(with_scans.size(), kMostNamed); ++k) {
    problem.append(k == 0 ? "" : ", ").append(with_scans[k]);
  }
  problem += with_scans.size() > kMostNamed ? ", ..." : "";
  return bad_input(folder.string(), problem, "name one of these");
}

}  // namespace

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
  std::error_code missing;
  const fs::file_status status = fs::status(path, missing);
  if (!fs::exists(status)) {
    return bad_input(path.string(), "no such file or folder", "check the name");
  }
  if (!fs::is_directory(status)) {
    return ScanFiles({path}, options);
  }
  std::error_code error;
  FolderContent content = content_of(path, error);
  if (error) {
    return bad_input(path.string(), "the folder cannot be read: " + error.message(), "make it readable");
  }
  if (content.scans.empty()) {
    return without_scans(path, content);
  }
  std::ranges::sort(content.scans);
  return ScanFiles(std::move(content.scans), options);
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
