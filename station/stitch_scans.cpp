// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/stitch_scans.h"

#include <algorithm>
#include <utility>

#include "registration/registrar.h"
#include "registration/unit_check.h"
#include "station/tablet_flags.h"
#include "triangulation/placed_precision.h"

namespace dubsar {

std::string size_fault(const RangeGrid& grid) {
  const RegistrationOptions usual;
  const double scale_mm = surface_scale_mm(grid);
  return scale_mm > 0 ? impossible_size({scale_mm, grid.spacing_mm}, usual.least_size_mm, usual.most_size_mm)
                      : "";
}

Status add_scan(Stitcher& stitcher, const StationScan& scan, const SampleFlags& flags, const ScanPose& pose,
                const JobContext& job) {
  Status added = stitcher.add(
      {scan.id, scan.grid.get(), &flags, pose.model_from_scanner, pose.sigma_mm, std::nullopt, pose.locked},
      job);
  if (!added && added.error().kind == ErrorKind::kBadInput) {
    added.error().where = scan.file;
  }
  return added;
}

Result<std::vector<ForeignFound>> add_without_foreign(Stitcher& stitcher, std::span<const StationScan> scans,
                                                      std::span<const ScanPose> poses,
                                                      const JobContext& job) {
  struct Placed {
    const StationScan* scan;
    const ScanPose* pose;
  };
  std::vector<Placed> placed;
  TabletFlags flags;
  for (const StationScan& scan : scans) {
    const auto pose = std::ranges::find(poses, scan.id, &ScanPose::id);
    if (pose == poses.end() || pose->status != PoseStatus::kRegistered) {
      continue;
    }
    if (const Status near = PlacedPrecision(*scan.grid).check(pose->model_from_scanner, scan.file); !near) {
      return std::unexpected(near.error());
    }
    placed.push_back({&scan, &*pose});
    flags.add(scan);
  }
  flags.follow(poses);
  for (const auto& [scan, pose] : placed) {
    if (const Status added = add_scan(stitcher, *scan, flags.of(scan->id), *pose, job); !added) {
      return std::unexpected(added.error());
    }
  }
  return flags.foreign();
}

std::vector<ScanCopy> take_out_with_copies(Stitcher& stitcher, const ForeignFound& found) {
  std::vector<ScanCopy> copies = stitcher.copies();
  std::erase_if(copies, [&](const ScanCopy& copy) { return copy.of_id != found.id; });
  for (const ScanCopy& copy : copies) {
    stitcher.remove(copy.id);
  }
  stitcher.remove(found.id);
  return copies;
}

}  // namespace dubsar
