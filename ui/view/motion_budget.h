// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>

#include "ui/view/shown_mesh.h"

namespace dubsar::ui {

/// How many faces are drawn at most while a surface is turned, and whether over half the pixels only: learned
/// from how long the pictures before took this machine.
class MotionBudget {
 public:
  [[nodiscard]] std::size_t faces() const { return faces_; }
  /// Half the pixels; so it is taken until the machine was seen to be fast.
  [[nodiscard]] bool is_slow() const { return slow_; }

  /// The next pictures have another size, or are lit otherwise.
  void begin_other_pictures();
  /// A picture of `drawn` faces, with `all` that there are, took so long.
  void took(std::size_t drawn, bool all, double spent_s);

 private:
  static constexpr std::size_t kMost = std::size_t{1} << 30U;
  static constexpr std::size_t kAtFirst = kFacesInMotion * 3;

  std::size_t faces_ = kAtFirst;
  bool slow_ = true;
  // Of pictures like the last one:
  double least_s_ = 0;            ///< the quickest: so long with few faces; 0 before the first
  std::size_t too_many_ = kMost;  ///< faces that took too long
  int too_long_ = 0;              ///< pictures in a row
};

}  // namespace dubsar::ui
