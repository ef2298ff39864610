// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/rigid_transform.h"

namespace dubsar {

enum class PoseStatus { kRegistered, kUnsure, kFailed };

/// The pose of one scan in the model frame, as registration judged it. Only kRegistered poses are meshed.
struct ScanPose {
  int id = 0;                         ///< the scan's number in its session or folder
  std::string file;                   ///< its original name
  RigidTransform model_from_scanner;  ///< the best guess there is; meaningless when failed
  PoseStatus status = PoseStatus::kFailed;
  double rms_mm = 0;    ///< point-to-plane residual over the overlap
  double sigma_mm = 0;  ///< predicted surface displacement error of this pose
  double overlap = 0;   ///< with the rest of the model, over the smaller scan, in [0,1]
  std::string reason;   ///< why it is unsure or failed and what would settle it; empty when registered
  std::string warning;  ///< what is wrong with a registered scan although its pose is sure; mostly empty
  bool locked = false;  ///< fixed by the operator; relaxation leaves it alone
  /// Of an unsure scan that fits others which are not of the model either: the lowest id of them all, with
  /// itself; their poses are in one frame of their own then. -1 of any other.
  int group_apart = -1;
  /// Covariance of the left perturbation twist (omega rad, v mm) about the scan's centroid in the model
  /// frame.
  std::optional<Eigen::Matrix<double, 6, 6>> covariance;
  /// The scan's files in the package that the pose is of ("scans/ply/003.ply"); empty elsewhere.
  std::vector<std::string> packed_as{};
};

/// Whether its rms_mm was measured: the 0 of a scan that lies on no other is none.
[[nodiscard]] inline bool was_compared(const ScanPose& pose) {
  return pose.overlap > 0 || pose.rms_mm > 0;
}

[[nodiscard]] constexpr const char* to_string(PoseStatus status) {
  switch (status) {
    case PoseStatus::kRegistered:
      return "registered";
    case PoseStatus::kUnsure:
      return "unsure";
    case PoseStatus::kFailed:
      break;
  }
  return "failed";
}

}  // namespace dubsar
