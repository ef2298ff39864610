// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/rigid_transform.h"
#include "registration/icp_information.h"

namespace dubsar {

/// The pose after a left twist (omega rad, v mm) about the centre.
[[nodiscard]] inline RigidTransform twisted(const RigidTransform& pose, const Vector6d& twist,
                                            const Eigen::Vector3d& center_mm) {
  const RigidTransform turn = RigidTransform::from_twist(twist.head<3>(), Eigen::Vector3d::Zero());
  return RigidTransform{turn.rotation * pose.rotation,
                        turn.rotation * (pose.translation_mm - center_mm) + center_mm + twist.tail<3>()}
      .orthonormalised();
}

}  // namespace dubsar
