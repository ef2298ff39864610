// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dubsar {

/// What has become of one sample of the tablet. The numbers are those of docs/formats/sample_states.md.
enum class SampleState : std::uint8_t {
  kNone = 0,          ///< no sample of the tablet in this cell
  kSampled = 1,       ///< its surroundings are well sampled by its own scan
  kRed = 2,           ///< still to scan
  kCleared = 3,       ///< sparse in its scan, well sampled by another
  kInterpolated = 4,  ///< excused: beside a small gap over which interpolation is good enough
  kUnreachable = 5,   ///< excused: nothing sees the place densely
  kStray = 6,         ///< excused: a return from nowhere
};
inline constexpr int kSampleStateCount = 7;

[[nodiscard]] constexpr const char* to_string(SampleState state) {
  constexpr const char* kNames[] = {"none",         "sampled",     "red",  "cleared",
                                    "interpolated", "unreachable", "stray"};
  return kNames[static_cast<int>(state)];
}

/// The states of one scan's samples, by cell of its grid.
struct SampleStates {
  std::vector<SampleState> state;
  std::vector<int> cleared_by;  ///< id of the lowest scan that clears it; -1 where none does
  std::vector<int> reason;      ///< position in `reasons`, -1 unless the state is an excuse
  std::vector<std::string> reasons;
};

}  // namespace dubsar
