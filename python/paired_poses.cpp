// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "python/paired_poses.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "core/utf8.h"

namespace dubsar::python {

namespace {

using Grids = std::vector<GridPointer>;

/// As the command has it: whatever folder the scan lay in then.
std::string name_of(const std::string& file) {
  return std::filesystem::path(file).filename().string();
}

/// Places of grids by name, the nameless left out.
std::multimap<std::string, int> places_by_name(const Grids& grids) {
  std::multimap<std::string, int> out;
  for (std::size_t k = 0; k < grids.size(); ++k) {
    if (const std::string name = name_of(grids[k]->source); !name.empty()) {
      out.emplace(name, static_cast<int>(k));
    }
  }
  return out;
}

void check_place(const ScanPose& pose, const Grids& grids, const std::multimap<std::string, int>& places) {
  if (pose.id < 0 || static_cast<std::size_t>(pose.id) >= grids.size()) {
    raise({ErrorKind::kUsage,
           "there is no grid of pose " + std::to_string(pose.id),
           {},
           "a pose's id is its grid's place in the list, where the names of files do not tell"});
  }
  const std::string& source = grids[static_cast<std::size_t>(pose.id)]->source;
  const std::string name = name_of(pose.file);
  if (!source.empty() && name != name_of(source) && places.contains(name)) {
    raise({ErrorKind::kUsage,
           "pose " + std::to_string(pose.id) + " is of " + one_line(pose.file) + ", and " +
               grid_name(grids, pose.id) + " stands in that place",
           {},
           "give the grids in the order of the poses' ids, or each a source of its own"});
  }
}

}  // namespace

std::string grid_name(const Grids& grids, int place) {
  const std::string& source = grids[static_cast<std::size_t>(place)]->source;
  return "grid " + std::to_string(place) + (source.empty() ? "" : " (" + one_line(source) + ")");
}

std::vector<ScanPose> paired_poses(std::vector<ScanPose> poses, const Grids& grids) {
  const std::multimap<std::string, int> places = places_by_name(grids);
  const bool names_tell =
      std::ranges::all_of(poses, [&](const ScanPose& pose) { return places.count(name_of(pose.file)) == 1; });
  std::set<int> taken;
  for (ScanPose& pose : poses) {
    if (names_tell) {
      pose.id = places.find(name_of(pose.file))->second;
    } else {
      check_place(pose, grids, places);
    }
    if (!taken.insert(pose.id).second) {
      raise({ErrorKind::kUsage, "two poses are of " + grid_name(grids, pose.id), {}, "leave the right one"});
    }
  }
  return poses;
}

}  // namespace dubsar::python
