// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/scan_pose.h"
#include "registration/foreign_matter.h"
#include "station/command/left_out_scans.h"
#include "station/scan_set.h"
#include "station/station_scan.h"
#include "station/tablet_label.h"
#include "triangulation/stitcher.h"

namespace dubsar {

/// What a stitcher was given.
struct Taken {
  std::size_t scans = 0;
  std::map<int, std::string> names;  ///< of those, by id
  /// That the scans of a folder were read from, by id: a scan may be called otherwise. Of others, too.
  std::map<int, std::filesystem::path> files;
  std::set<int> made_up;              ///< by the simulator, as their grids say. Of others, too
  bool lacks_poses = false;           ///< of a scan that has not been judged yet: then the rest was not taken
  std::vector<ScanPose> poses;        ///< of those
  std::set<int> without_sigma;        ///< of those whose poses say nothing of how far they may be off
  std::vector<LeftOutScan> left_out;  ///< the others that stand

  void note_file(const StationScan& scan) {
    files[scan.id] = scan.read_from;
    if (is_made_up(*scan.grid)) {
      made_up.insert(scan.id);
    }
  }
  void leave_out(LeftOutScan scan) {
    warn_of(scan);
    left_out.push_back(std::move(scan));
  }
};

/// What of the set cannot be read. Whether the poses of a file, where there is one, make it a part of the
/// mesh is not known of a file that they do not name: it may be the one that is lacking of theirs. `rest`:
/// the poses that no scan was given.
[[nodiscard]] Status leave_out_unread(const ScanSet& set, const std::filesystem::path& path,
                                      const std::vector<ScanPose>* rest, Taken& taken);
/// Says in which scans something foreign was found. Of one that has nothing else nothing is stitched.
void tell_foreign(const std::vector<ForeignFound>& foreign, Taken& taken, Stitcher& stitcher);
/// Those that only repeat another's samples.
void leave_out_copies(const Stitcher& stitcher, Taken& taken);
/// Those without a triangle: their poses need not be wrong.
void leave_out_without_surface(const Stitcher& stitcher, Taken& taken);
/// That the vertices' sigma lacks what poses do not say of themselves. One scan, against which the others
/// lie, need not say anything.
void tell_unknown_sigmas(const Taken& taken, const std::string& poses_file);

}  // namespace dubsar
