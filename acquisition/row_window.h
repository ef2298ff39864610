// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <deque>
#include <functional>

#include "acquisition/swept_light.h"
#include "core/result.h"
#include "drivers/device.h"

namespace dubsar {

/// Rows of one scan on their way from stripes to profiles: each waits until as many came behind it as have a
/// say in it (SweptLight::reach).
class RowWindow {
 public:
  using Give = std::function<Status(const Profile& profile)>;
  /// `options` of the stripes; only those of the adaptive detector are corrected. `step` between rows, mm or
  /// radians.
  RowWindow(const Triangulator& triangulator, const StripeOptions& options, double step);

  /// Gives on the rows that have waited long enough; what `give` returns ends it.
  Status take(SweptRow row, const Give& give);
  /// Gives on the rows that still wait.
  Status finish(const Give& give);

 private:
  Status give_next(const Give& give);

  const Triangulator& triangulator_;
  SweptLight light_;
  std::size_t reach_;
  std::deque<SweptRow> rows_;
  std::size_t next_ = 0;  ///< of rows_, the first that was not given on
  TriangulatedProfile profile_;
};

}  // namespace dubsar
