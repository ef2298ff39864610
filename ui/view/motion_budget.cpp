// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/view/motion_budget.h"

#include <algorithm>

namespace dubsar::ui {

namespace {

/// A picture that takes longer to draw makes the window feel stuck while it is turned.
constexpr double kSlowS = 0.05;
/// A machine that draws one so fast is given more: 200 a second.
constexpr double kFastS = 0.005;
/// So many in a row are no hiccup.
constexpr int kNoHiccup = 3;

}  // namespace

void MotionBudget::begin_other_pictures() {
  least_s_ = 0;
  too_many_ = kMost;
  too_long_ = 0;
}

void MotionBudget::took(std::size_t drawn, bool all, double spent_s) {
  if (spent_s > kSlowS) {
    faces_ = slow_ ? std::max(kFacesInMotion, faces_ / 2) : faces_;
    slow_ = true;
    return;
  }
  least_s_ = least_s_ > 0 ? std::min(least_s_, spent_s) : spent_s;
  if (spent_s >= kFastS) {
    if (faces_ > kAtFirst && drawn > kAtFirst && ++too_long_ == kNoHiccup) {
      too_many_ = drawn;
      faces_ = std::max(kAtFirst, drawn - 1);
      too_long_ = 0;
    }
    return;
  }
  too_long_ = 0;
  slow_ = false;  // four times the pixels are drawn soon enough too
  if (all) {
    return;
  }
  // What any picture takes, however few faces are in it, does not grow with them. What these few took beyond
  // it says little of many more: twice as many as before at most.
  const double share = (kFastS - least_s_) / std::max(spent_s - least_s_, 1e-9);
  const auto in_time = static_cast<std::size_t>(
      std::min(static_cast<double>(kMost), share * static_cast<double>(std::max<std::size_t>(1, drawn))));
  faces_ = std::max(faces_, std::min({2 * faces_, in_time, too_many_ - 1}));
}

}  // namespace dubsar::ui
