// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

#include "station/live_state.h"
#include "ui/shell/text_table.h"

namespace dubsar::ui {

/// "0.5"; "< 0.1" where rounding would leave nothing of it.
[[nodiscard]] std::string area_words(double mm2, Language language);
/// mm² that are red, and of one face of it.
[[nodiscard]] double red_mm2(const RedMap& map);
[[nodiscard]] double face_mm2(const RedMap& map, Face face, RegionState state);

/// Places of one side that are excused for one reason.
struct ExcusedPlaces {
  Face face = Face::kObverse;
  double area_mm2 = 0;
  std::string reason;
};

/// Largest first. Places that lack no surface are not among them.
[[nodiscard]] std::vector<ExcusedPlaces> excused_places(const RedMap& map);
/// mm²; 0 where rounding leaves nothing of it.
[[nodiscard]] double excused_mm2(const RedMap& map);
/// More than 1 % of what there is to see of a side is excused: nobody may call it whole.
[[nodiscard]] bool is_much_excused(const LiveState& state, Face face);
[[nodiscard]] bool is_much_excused(const LiveState& state);
/// What is excused of each side, with where the reasons stand, as sentences; empty where nothing is.
[[nodiscard]] std::string excused_sides(const RedMap& map, Language language);

/// How a side stands in the checklist.
struct FaceState {
  bool whole = false;  ///< nothing of it is missing
  bool lacks = false;
  bool excused = false;  ///< nothing of it is red, but much is excused
  std::string note;
};

[[nodiscard]] FaceState face_state(const LiveState& state, Face face, Wording wording);

}  // namespace dubsar::ui
