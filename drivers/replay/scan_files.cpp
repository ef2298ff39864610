// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/replay/scan_files.h"

#include <algorithm>
#include <utility>

#include "formats/scan_folder.h"

namespace dubsar::replay {

namespace fs = std::filesystem;

namespace {

/// What helps where files lie that are not read as they are.
std::string mend_of(const ScanFolder& content) {
  std::string mend;
  if (content.packed) {
    mend = "unpack the packed files";
  }
  if (content.tables) {
    mend.append(mend.empty() ? "" : ", ").append("rename .csv to .xyz where the lines are points");
  }
  if (!content.few_points.empty()) {
    mend.append(mend.empty() ? "" : ", ")
        .append("name a file by itself if it is a scan of fewer than 100 points");
  }
  return mend.empty() ? "name a folder with range grids (PLY, PTX or point files)" : mend;
}

/// Says what is there instead, so that whoever named the folder above the scans sees which to name.
std::unexpected<Error> without_scans(const fs::path& folder, const ScanFolder& content) {
  constexpr std::size_t kMostNamed = 5;
  std::vector<std::string> with_scans;
  for (const fs::path& subfolder : content.subfolders) {
    if (const Result<ScanFolder> below = look_into_folder(subfolder); below && !below->scans.empty()) {
      with_scans.push_back(subfolder.filename().string());
    }
  }
  const std::size_t files = content.other_files + content.few_points.size();
  std::string problem = files > 0 ? "none of the " + std::to_string(files) + " files in the folder is a scan"
                        : content.subfolders.empty() ? "the folder is empty"
                                                     : "the folder holds no files";
  const std::string of = std::to_string(content.subfolders.size());
  if (with_scans.empty()) {
    problem += content.subfolders.empty() ? "" : ", and of its subfolders (" + of + ") none holds scans";
    return bad_input(folder.string(), problem, mend_of(content));
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
  Result<ScanFolder> content = look_into_folder(path);
  if (!content) {
    return std::unexpected(content.error());
  }
  if (content->scans.empty()) {
    return without_scans(path, *content);
  }
  ScanFiles files(std::move(content->scans), options);
  files.passed_over_ = content->passed_over();
  return files;
}

Result<std::optional<ScanData>> ScanFiles::next(const JobContext& job) {
  while (waiting_.empty()) {
    if (next_file_ == files_.size()) {
      return std::optional<ScanData>();
    }
    remarks_.clear();
    options_.remark = [this](const std::string& scan, const std::string& remark) {
      remarks_.emplace_back(scan, remark);
    };
    options_.job = &job;
    Result<std::vector<ScanData>> scans = read_scan_file(files_[next_file_++], options_);
    options_.job = nullptr;
    if (!scans) {
      next_file_ -= scans.error().kind == ErrorKind::kCancelled ? 1 : 0;
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
