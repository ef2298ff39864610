// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Horn, Closed-form solution of absolute orientation using unit quaternions, J. Opt. Soc. Am. A 4 (1987).
#include "registration/absolute_orientation.h"

#include <Eigen/Eigenvalues>

namespace dubsar {

namespace {

/// The quaternion is undetermined when its two largest eigenvalues fall together.
constexpr double kLeastEigenvalueGap = 1e-9;

}  // namespace

std::optional<RigidTransform> absolute_orientation(std::span<const Eigen::Vector3d> source,
                                                   std::span<const Eigen::Vector3d> target,
                                                   std::span<const double> weights) {
  if (source.size() != target.size() || (!weights.empty() && weights.size() != source.size())) {
    return std::nullopt;
  }
  const auto weight = [&](std::size_t i) { return weights.empty() ? 1.0 : weights[i]; };
  double total = 0;
  std::size_t used = 0;
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  Eigen::Vector3d to = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < source.size(); ++i) {
    const double w = weight(i);
    if (!(w > 0)) {
      continue;
    }
    total += w;
    from += w * source[i];
    to += w * target[i];
    ++used;
  }
  if (used < 3) {
    return std::nullopt;
  }
  from /= total;
  to /= total;
  Eigen::Matrix3d s = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < source.size(); ++i) {
    const double w = weight(i);
    if (w > 0) {
      s += (w / total) * (source[i] - from) * (target[i] - to).transpose();
    }
  }
  if (!s.allFinite()) {
    return std::nullopt;
  }
  Eigen::Matrix4d n;
  n << s(0, 0) + s(1, 1) + s(2, 2), s(1, 2) - s(2, 1), s(2, 0) - s(0, 2), s(0, 1) - s(1, 0),  //
      s(1, 2) - s(2, 1), s(0, 0) - s(1, 1) - s(2, 2), s(0, 1) + s(1, 0), s(2, 0) + s(0, 2),   //
      s(2, 0) - s(0, 2), s(0, 1) + s(1, 0), s(1, 1) - s(0, 0) - s(2, 2), s(1, 2) + s(2, 1),   //
      s(0, 1) - s(1, 0), s(2, 0) + s(0, 2), s(1, 2) + s(2, 1), s(2, 2) - s(0, 0) - s(1, 1);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(n);
  const Eigen::Vector4d values = eigen.eigenvalues();
  if (values[3] - values[2] <= kLeastEigenvalueGap * s.norm()) {
    return std::nullopt;
  }
  const Eigen::Vector4d q = eigen.eigenvectors().col(3);
  RigidTransform out;
  out.rotation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
  out.translation_mm = to - out.rotation * from;
  return out;
}

}  // namespace dubsar
