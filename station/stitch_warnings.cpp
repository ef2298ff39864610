// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/stitch_warnings.h"

#include <fmt/format.h>

#include <set>

namespace dubsar {

std::vector<std::string> warnings_of_places(const Stitcher& stitcher,
                                            const std::map<int, std::string>& names) {
  std::vector<std::string> lines;
  std::set<int> touching;
  const std::vector<Stitcher::Overlap> overlaps = stitcher.overlaps();
  for (const Stitcher::Overlap& overlap : overlaps) {
    touching.insert(overlap.id);
    touching.insert(overlap.other_id);
  }
  // A scan that touches no other lies wrong, or alone; the mesh shows it beside the rest.
  for (const auto& [id, name] : names) {
    if (names.size() > 1 && !touching.contains(id)) {
      lines.push_back(name +
                      " overlaps no other scan where its pose puts it; look whether that pose is right");
    }
  }
  for (const Stitcher::Overlap& overlap : overlaps) {
    if (overlap.is_off()) {
      lines.push_back(fmt::format(
          "scans {} and {} lie {:.2f} mm apart where they overlap, more than noise explains; the "
          "mesh is less reliable, and may have a scan where the others fit it, not where its pose "
          "puts it; register them again",
          overlap.id, overlap.other_id, overlap.step_mm));
    }
  }
  return lines;
}

std::string left_out_sentence(const std::string& name, const std::string& word, const std::string& reason) {
  return name + " is left out: " + word + (word.empty() || reason.empty() ? "" : ", ") + reason;
}

std::string copy_reason(const ScanCopy& copy, const std::map<int, std::string>& names) {
  return "it has the very samples of " + names.at(copy.of_id) + ", and counts as the same scan";
}

std::string no_surface_reason() {
  return "it has no surface, since no three neighbouring samples of its rows and columns make a triangle; "
         "scan again, nearer or with more of the tablet in view";
}

Status check_has_surface(const Mesh& mesh, const std::string& where) {
  if (!mesh.faces.empty()) {
    return {};
  }
  return bad_input(where,
                   fmt::format("its scans have no surface: nowhere do {} triangles of neighbouring samples "
                               "hang together",
                               StitchOptions().least_component_faces),
                   "scan again, nearer or with more of the tablet in view");
}

}  // namespace dubsar
