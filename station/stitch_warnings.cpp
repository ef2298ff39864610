// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/stitch_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "core/utf8.h"

namespace dubsar {

namespace {

constexpr const char* kWhatToDo =
    "more than noise explains; the mesh is less reliable, and may have a scan where the others fit it, not "
    "where its pose puts it; register them again";

/// A scan that would explain why others lie apart from it.
struct Suspect {
  int id = 0;
  std::size_t others = 0;
};

/// The fewest scans, as far as the simplest choice finds them, that all pairs have a part in: first who lies
/// apart from most, of equals who is farthest off.
std::vector<Suspect> suspects(std::vector<Stitcher::Overlap> off, const std::map<int, double>& moved_mm) {
  std::map<int, std::size_t> others;
  for (const Stitcher::Overlap& pair : off) {
    ++others[pair.id];
    ++others[pair.other_id];
  }
  const auto how_far = [&](int id) { return moved_mm.contains(id) ? moved_mm.at(id) : 0.0; };
  std::vector<Suspect> out;
  while (!off.empty()) {
    std::map<int, std::size_t> left;
    for (const Stitcher::Overlap& pair : off) {
      ++left[pair.id];
      ++left[pair.other_id];
    }
    const int worst = std::ranges::max_element(left, {}, [&](const auto& scan) {
                        return std::pair(scan.second, how_far(scan.first));
                      })->first;
    out.push_back({worst, others.at(worst)});
    std::erase_if(off, [&](const auto& pair) { return pair.id == worst || pair.other_id == worst; });
  }
  return out;
}

/// "scan_3.ply (apart from 7 others, 0.31 mm off), … and 5 more scans"
std::string named(const std::vector<Suspect>& found, const std::map<int, std::string>& names,
                  const std::map<int, double>& moved_mm) {
  constexpr std::size_t kMost = 4;
  std::string text;
  const std::size_t said = std::min(found.size(), kMost);
  for (std::size_t k = 0; k < said; ++k) {
    const Suspect& scan = found[k];
    const bool is_last = k + 1 == found.size();
    text += k == 0 ? "" : is_last ? " and " : ", ";
    text += fmt::format("{} (apart from {} other{}", one_line(names.at(scan.id)), scan.others,
                        scan.others == 1 ? "" : "s");
    text += moved_mm.contains(scan.id) ? fmt::format(", {:.2f} mm off)", moved_mm.at(scan.id)) : ")";
  }
  const std::size_t more = found.size() - said;
  return more == 0 ? text : fmt::format("{} and {} more scan{}", text, more, more == 1 ? "" : "s");
}

std::vector<Stitcher::Overlap> pairs_off(const Stitcher& stitcher) {
  std::vector<Stitcher::Overlap> overlaps = stitcher.overlaps();
  std::erase_if(overlaps, [](const Stitcher::Overlap& overlap) { return !overlap.is_off(); });
  return overlaps;
}

}  // namespace

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
  constexpr std::size_t kFew = 2;
  const std::vector<Stitcher::Overlap> off = pairs_off(stitcher);
  if (off.size() > kFew) {
    const std::map<int, double> moved_mm = stitcher.moved_mm();
    lines.push_back(fmt::format(
        "{} of {} pairs of scans lie apart where they overlap, by up to {:.2f} mm, {}; at fault "
        "seem: {}",
        off.size(), overlaps.size(), std::ranges::max(off, {}, &Stitcher::Overlap::step_mm).step_mm,
        kWhatToDo, named(suspects(off, moved_mm), names, moved_mm)));
    return lines;
  }
  for (const Stitcher::Overlap& overlap : off) {
    lines.push_back(fmt::format("scans {} and {} lie {:.2f} mm apart where they overlap, {}", overlap.id,
                                overlap.other_id, overlap.step_mm, kWhatToDo));
  }
  return lines;
}

nlohmann::ordered_json apart_json(const Stitcher& stitcher) {
  auto out = nlohmann::ordered_json::array();
  for (const Stitcher::Overlap& pair : pairs_off(stitcher)) {
    out.push_back({{"ids", {pair.id, pair.other_id}}, {"mm", pair.step_mm}});
  }
  return out;
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
