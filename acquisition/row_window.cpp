// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/row_window.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace dubsar {

RowWindow::RowWindow(const Triangulator& triangulator, const StripeOptions& options, double step)
    : triangulator_(triangulator),
      light_(triangulator, options.sigma_px),
      reach_(options.method == StripeMethod::kAdaptive ? static_cast<std::size_t>(light_.reach(step)) : 0) {}

Status RowWindow::take(SweptRow row, const Give& give) {
  rows_.push_back(std::move(row));
  while (rows_.size() - next_ > reach_) {
    if (Status given = give_next(give); !given) {
      return given;
    }
  }
  return {};
}

Status RowWindow::finish(const Give& give) {
  while (next_ < rows_.size()) {
    if (Status given = give_next(give); !given) {
      return given;
    }
  }
  return {};
}

Status RowWindow::give_next(const Give& give) {
  const std::size_t first = next_ - std::min(next_, reach_);
  const std::size_t end = std::min(rows_.size(), next_ + reach_ + 1);
  std::vector<const SweptRow*> around;
  for (std::size_t k = first; k < end; ++k) {
    around.push_back(&rows_[k]);
  }
  const SweptRow& row = rows_[next_];
  triangulator_.triangulate(row.stripe, row.position, profile_);
  if (reach_ > 0) {
    light_.correct(around, next_ - first, profile_);
  }
  Profile out;
  out.row = row.row;
  out.x = profile_.x;
  out.y = profile_.y;
  out.z = profile_.z;
  out.valid = profile_.valid;
  out.intensity = row.stripe.peak;
  out.confidence = row.stripe.confidence;
  out.timestamp_ns = row.timestamp_ns;
  ++next_;
  Status given = give(out);
  while (next_ > reach_) {
    rows_.pop_front();
    --next_;
  }
  return given;
}

}  // namespace dubsar
