// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What of the red map is told in mm²: of the whole, and by the sides of the tablet.
#include "ui/operator/map_areas.h"

#include <algorithm>
#include <functional>
#include <numeric>

#include "ui/shell/face_texts.h"
#include "ui/shell/widgets.h"

namespace dubsar::ui {

namespace {

constexpr double kLeastToldMm2 = 0.05;  ///< what is less is rounded away
constexpr double kMuchExcused = 0.01;   ///< of a side

}  // namespace

std::string area_words(double mm2, Language language) {
  return mm2 < kLeastToldMm2 ? decimal("< 0.1", language) : decimal(mm2, 1, language);
}

double red_mm2(const RedMap& map) {
  double sum = 0;
  for (int face = 0; face < kFaceCount; ++face) {
    sum += face_mm2(map, static_cast<Face>(face), RegionState::kRed);
  }
  return sum;
}

double face_mm2(const RedMap& map, Face face, RegionState state) {
  double sum = 0;
  for (const RedRegion& region : map.regions) {
    sum += region.face == face && region.state == state ? region.area_mm2 : 0.0;
  }
  return sum;
}

std::vector<ExcusedPlaces> excused_places(const RedMap& map) {
  std::vector<ExcusedPlaces> out;
  for (const RedRegion& region : map.regions) {
    if (region.state != RegionState::kExcused || !(region.area_mm2 > 0)) {
      continue;
    }
    const auto same = std::ranges::find_if(out, [&](const ExcusedPlaces& one) {
      return one.face == region.face && one.reason == region.reason;
    });
    if (same == out.end()) {
      out.push_back({region.face, region.area_mm2, region.reason});
    } else {
      same->area_mm2 += region.area_mm2;
    }
  }
  std::ranges::stable_sort(out, std::ranges::greater(), &ExcusedPlaces::area_mm2);
  return out;
}

double excused_mm2(const RedMap& map) {
  double sum = 0;
  for (const ExcusedPlaces& one : excused_places(map)) {
    sum += one.area_mm2;
  }
  return sum < kLeastToldMm2 ? 0.0 : sum;
}

bool is_much_excused(const LiveState& state, Face face) {
  if (!state.red_map) {
    return false;
  }
  const double excused = face_mm2(*state.red_map, face, RegionState::kExcused);
  const double all = state.seen_mm2[static_cast<std::size_t>(face)] +
                     face_mm2(*state.red_map, face, RegionState::kRed) + excused;
  return excused > std::max(kLeastToldMm2, kMuchExcused * all);
}

bool is_much_excused(const LiveState& state) {
  bool much = false;
  for (int face = 0; face < kFaceCount; ++face) {
    much = much || is_much_excused(state, static_cast<Face>(face));
  }
  return much;
}

std::string excused_sides(const RedMap& map, Language language) {
  std::string sides;
  for (int face = 0; face < kFaceCount; ++face) {
    const double mm2 = face_mm2(map, static_cast<Face>(face), RegionState::kExcused);
    if (mm2 > kLeastToldMm2) {
      sides += fmt::format("{}{} {} mm²", sides.empty() ? "" : ", ", text_of(kFaceTexts[face], language),
                           area_words(mm2, language));
    }
  }
  return sides.empty() ? sides : filled(text_of(Text::kExcusedSides, language), sides);
}

FaceState face_state(const LiveState& state, Face face, Wording wording) {
  // While a hole gapes, a face without red may be one that nobody has looked at yet: no tick then.
  constexpr double kSmallHoles = 0.05;
  const double seen_mm2 = std::accumulate(state.seen_mm2.begin(), state.seen_mm2.end(), 0.0);
  const bool small_holes = state.red_map && red_mm2(*state.red_map) < kSmallHoles * seen_mm2;
  const double red = state.red_map ? face_mm2(*state.red_map, face, RegionState::kRed) : 0.0;
  const double excused = state.red_map ? face_mm2(*state.red_map, face, RegionState::kExcused) : 0.0;
  const auto f = static_cast<std::size_t>(face);
  // A hole is listed under one face; its rim may run over others.
  const bool known = state.red_map && (state.seen_mm2[f] > 0 || red > 0);
  const bool done =
      known && red <= 0 && (state.red_map->conclusive || (small_holes && state.red_points[f] == 0));
  FaceState out;
  out.excused = is_much_excused(state, face) && (done || !known);
  out.whole = done && !out.excused;
  out.lacks = known && (red > 0 || state.red_points[f] > 0) && !done;
  out.note = !known      ? text_of(Text::kNoArea, wording)
             : red > 0   ? filled(text_of(Text::kRedArea, wording), area_words(red, wording.language))
             : out.lacks ? text_of(Text::kRedRim, wording)
             : !done     ? text_of(Text::kNoRedSoFar, wording)
                         : std::string();
  if (excused > kLeastToldMm2) {
    out.note += (out.note.empty() ? "" : ", ") +
                filled(text_of(Text::kExcused, wording), area_words(excused, wording.language));
  }
  return out;
}

}  // namespace dubsar::ui
