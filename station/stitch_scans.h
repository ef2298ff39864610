// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/job.h"
#include "core/result.h"
#include "core/scan_pose.h"
#include "registration/foreign_matter.h"
#include "station/station_scan.h"
#include "triangulation/stitcher.h"

namespace dubsar {

/// Why the grid of a scan cannot be in millimetres; empty when it may be. Registration refuses such scans:
/// this is for those whose poses come from elsewhere.
[[nodiscard]] std::string size_fault(const RangeGrid& grid);

/// Gives the stitcher a scan in its place, with these flags in place of its own. What the stitcher refuses is
/// named by the scan's file. Errors: those of Stitcher::add().
[[nodiscard]] Status add_scan(Stitcher& stitcher, const StationScan& scan, const SampleFlags& flags,
                              const ScanPose& pose, const JobContext& job);

/// Gives the stitcher the registered ones of these scans, each without what the others show to be foreign in
/// it; what that is, by scan (sentence_of()). Takes what it needs: the scans may go. Errors: kBadInput where
/// a pose puts a scan too far from the origin for float, and those of Stitcher::add().
[[nodiscard]] Result<std::vector<ForeignFound>> add_without_foreign(Stitcher& stitcher,
                                                                    std::span<const StationScan> scans,
                                                                    std::span<const ScanPose> poses,
                                                                    const JobContext& job);

/// Takes a scan of which nothing is left (ForeignFound::is_all()) out again, and with it those that only
/// repeat its samples, one of which would come in its place. These, as they were known until then.
std::vector<ScanCopy> take_out_with_copies(Stitcher& stitcher, const ForeignFound& found);

}  // namespace dubsar
