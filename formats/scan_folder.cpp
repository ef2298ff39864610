// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/scan_folder.h"

#include <algorithm>

#include "core/lower_case.h"
#include "formats/grid_reader.h"

namespace dubsar {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostNamed = 5;

}  // namespace

std::string ScanFolder::passed_over() const {
  if (few_points.empty()) {
    return {};
  }
  std::string names;
  for (std::size_t k = 0; k < std::min(few_points.size(), kMostNamed); ++k) {
    names.append(k == 0 ? "" : ", ").append(few_points[k].filename().string());
  }
  names += few_points.size() > kMostNamed ? ", ..." : "";
  return "passed over, for text of fewer than " + std::to_string(kLeastPointLines) +
         " points is hardly a scan: " + names + "; name such a file itself if it is one";
}

Result<ScanFolder> look_into_folder(const fs::path& folder) {
  ScanFolder found;
  std::vector<fs::path> doubtful;
  bool point_txt = false;
  std::error_code error;
  fs::directory_iterator it(folder, error);
  for (const fs::directory_iterator end; !error && it != end; it.increment(error)) {
    const fs::path& path = it->path();
    std::error_code ignored;
    if (path.filename().string().starts_with('.')) {
      continue;
    }
    if (it->is_directory(ignored)) {
      found.subfolders.push_back(path);
      continue;
    }
    const std::string extension = in_lower_case(path.extension().string());
    switch (kind_of_file(path)) {
      case FileKind::kScan:
        found.scans.push_back(path);
        point_txt = point_txt || extension == ".txt";
        break;
      case FileKind::kFewPoints:
        found.few_points.push_back(path);
        break;
      case FileKind::kDoubtful:
        doubtful.push_back(path);
        break;
      case FileKind::kOther:
        // Sockets and the like are no files.
        found.other_files += it->is_regular_file(ignored) ? 1 : 0;
        found.tables = found.tables || extension == ".csv";
        found.packed = found.packed || has_packed_name(path);
        break;
    }
  }
  if (error) {
    return bad_input(folder.string(), "the folder cannot be read: " + error.message(), "make it readable");
  }
  if (point_txt) {
    found.scans.insert(found.scans.end(), doubtful.begin(), doubtful.end());
  } else {
    found.other_files += doubtful.size();
  }
  std::ranges::sort(found.scans);
  std::ranges::sort(found.few_points);
  return found;
}

}  // namespace dubsar
