// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/conf_unit.h"

#include <cstddef>
#include <optional>
#include <string>

#include "formats/atomic_file.h"
#include "formats/ply_header.h"
#include "formats/ply_scan.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

/// Headers hold under a kilobyte; what is longer tells no unit here.
constexpr std::size_t kHeadBytes = std::size_t{64} << 10U;

/// What cannot be read, or is no unit, is told by who reads the scan.
double mm_per_unit_in(const fs::path& file) {
  const Result<std::string> head = read_file_head(file, kHeadBytes);
  if (!head || !is_ply(*head)) {
    return 1;
  }
  const Result<PlyHeader> header = parse_ply_header(*head, file.string());
  return header ? mm_per_unit_of(*header, file.string()).value_or(1) : 1;
}

}  // namespace

bool is_conf(const fs::path& poses_file) {
  return poses_file.extension() == ".conf";
}

Result<double> mm_per_unit_of_scans(const fs::path& scans, const std::vector<ScanPose>& poses) {
  std::error_code not_there;
  const fs::path folder = fs::is_directory(scans, not_there) ? scans : scans.parent_path();
  std::optional<double> mm;
  fs::path of;
  for (const ScanPose& pose : poses) {
    const fs::path file = folder / fs::path(pose.file).filename();
    if (!fs::is_regular_file(file, not_there)) {
      continue;
    }
    const double its = mm_per_unit_in(file);
    if (!mm) {
      mm = its;
      of = file;
    } else if (its != *mm) {
      return bad_input(
          file.string(), "its numbers are in another unit than those of " + of.filename().string(),
          "a .conf is in the unit of its scans: write its poses as a poses.json, which says its own");
    }
  }
  return mm.value_or(1);
}

}  // namespace dubsar
