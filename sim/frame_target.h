// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/gray_image.h"
#include "core/rigid_transform.h"
#include "sim/scene.h"

namespace dubsar::sim {

/// What stands before the camera of a simulated rig, camera frame. Safe to ask from many threads.
class FrameTarget {
 public:
  FrameTarget() = default;
  FrameTarget(const FrameTarget&) = delete;
  FrameTarget& operator=(const FrameTarget&) = delete;
  virtual ~FrameTarget() = default;
  /// What the ray meets first; direction is a unit vector.
  [[nodiscard]] virtual std::optional<SceneHit> hit(const Eigen::Vector3d& origin_mm,
                                                    const Eigen::Vector3d& direction) const = 0;
  /// Whether something stands between a and b.
  [[nodiscard]] virtual bool blocked(const Eigen::Vector3d& a_mm, const Eigen::Vector3d& b_mm) const = 0;
  /// How many samples a pixel's side needs: more where an albedo changes at once.
  [[nodiscard]] virtual int samples_per_px() const { return 1; }
};

/// A tablet with its pins and its support. Keep the scene alive.
class SceneTarget : public FrameTarget {
 public:
  SceneTarget(const Scene& scene, const RigidTransform& tablet_from_camera)
      : scene_(scene), tablet_from_camera_(tablet_from_camera) {}
  [[nodiscard]] std::optional<SceneHit> hit(const Eigen::Vector3d& origin_mm,
                                            const Eigen::Vector3d& direction) const override;
  [[nodiscard]] bool blocked(const Eigen::Vector3d& a_mm, const Eigen::Vector3d& b_mm) const override;

 private:
  const Scene& scene_;
  RigidTransform tablet_from_camera_;
};

/// A flat board with a printed pattern in its plane z = 0, seen from -z: x to the right, y down the pattern.
class BoardTarget : public FrameTarget {
 public:
  /// `pattern` covers the board from its upper left corner, `origin_mm` before the board's own origin. Black
  /// is paper of albedo 0.06, white of 0.8.
  BoardTarget(GrayImage pattern, double mm_per_texel, const Eigen::Vector2d& origin_mm,
              const RigidTransform& camera_from_board)
      : pattern_(std::move(pattern)),
        mm_per_texel_(mm_per_texel),
        origin_mm_(origin_mm),
        camera_from_board_(camera_from_board) {}
  [[nodiscard]] std::optional<SceneHit> hit(const Eigen::Vector3d& origin_mm,
                                            const Eigen::Vector3d& direction) const override;
  [[nodiscard]] bool blocked(const Eigen::Vector3d& /*a_mm*/,
                             const Eigen::Vector3d& /*b_mm*/) const override {
    return false;
  }
  [[nodiscard]] int samples_per_px() const override { return 4; }

 private:
  GrayImage pattern_;
  double mm_per_texel_;
  Eigen::Vector2d origin_mm_;
  RigidTransform camera_from_board_;
};

}  // namespace dubsar::sim
