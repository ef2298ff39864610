// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pin_labels.h"

#include <algorithm>
#include <array>

namespace dubsar {

namespace {

/// Where a click was made that no tip was found near.
constexpr double kClickSigmaMm = 0.6;

}  // namespace

std::vector<SeenPin> labelled_tips(const std::vector<SeenPin>& detected, const std::vector<PinTip>& clicked,
                                   double tip_diameter_mm) {
  const double reach_mm = tip_diameter_mm + 1.0;
  std::vector<std::array<double, 3>> pairs;  // distance, click, detected
  for (std::size_t c = 0; c < clicked.size(); ++c) {
    for (std::size_t d = 0; d < detected.size(); ++d) {
      const double off = (detected[d].position_mm - clicked[c].position_mm).norm();
      if (off < reach_mm) {
        pairs.push_back({off, static_cast<double>(c), static_cast<double>(d)});
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<std::size_t> tip_of_click(clicked.size(), detected.size());
  std::vector<bool> used(detected.size(), false);
  for (const auto& [off, click, tip] : pairs) {
    const auto c = static_cast<std::size_t>(click);
    const auto d = static_cast<std::size_t>(tip);
    if (tip_of_click[c] == detected.size() && !used[d]) {
      tip_of_click[c] = d;
      used[d] = true;
    }
  }
  std::vector<SeenPin> out;
  for (std::size_t c = 0; c < clicked.size(); ++c) {
    if (tip_of_click[c] < detected.size()) {
      out.push_back(detected[tip_of_click[c]]);
      out.back().label = clicked[c].label;
    } else if (clicked[c].position_mm.allFinite()) {
      out.push_back({clicked[c].label, clicked[c].position_mm,
                     kClickSigmaMm * kClickSigmaMm * Eigen::Matrix3d::Identity()});
    }
  }
  for (std::size_t d = 0; d < detected.size(); ++d) {
    if (!used[d]) {
      out.push_back(detected[d]);
    }
  }
  return out;
}

}  // namespace dubsar
