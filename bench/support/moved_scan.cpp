// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/moved_scan.h"

#include <vector>

#include "core/rigid_transform.h"
#include "core/units.h"

namespace dubsar::bench {

std::shared_ptr<const RangeGrid> moved_scan(const RangeGrid& still, const Move& move) {
  auto out = std::make_shared<RangeGrid>(still);
  std::vector<std::size_t> valid;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < still.size(); ++i) {
    if (still.valid[i] != 0) {
      valid.push_back(i);
      middle += still.point(i).cast<double>();
    }
  }
  if (valid.empty()) {
    return out;
  }
  const auto count = static_cast<double>(valid.size());
  middle /= count;
  const std::size_t first = valid[static_cast<std::size_t>(move.after * (count - 1))];
  for (std::size_t k = 0; k < valid.size(); ++k) {
    const std::size_t i = valid[k];
    const double at_once = still.row_of(i) < still.row_of(first) ? 0.0 : 1.0;
    const double part = move.steadily ? static_cast<double>(k) / count : at_once;
    const RigidTransform turn = RigidTransform::from_twist(rad_from_deg(part) * move.turn_deg, {0, 0, 0});
    const Eigen::Vector3f p =
        (turn * (still.point(i).cast<double>() - middle) + middle + part * move.shift_mm).cast<float>();
    out->x[i] = p.x();
    out->y[i] = p.y();
    out->z[i] = p.z();
  }
  return out;
}

}  // namespace dubsar::bench
