// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/rollout.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "archive/side_curve.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

constexpr std::size_t kGrain = 1U << 12U;

using Triangle = std::array<std::uint32_t, 3>;

/// Puts faces on the plane that were vertices on it so far, and cuts those across the seam.
class Laying {
 public:
  Laying(Mesh& flat, double length_mm) : flat_(flat), length_mm_(static_cast<float>(length_mm)) {}

  /// true_mm: the corners before they were rolled out.
  void lay(const Triangle& face, const std::array<Eigen::Vector3f, 3>& true_mm) {
    std::array<float, 3> y = {flat_.positions[face[0]].y(), flat_.positions[face[1]].y(),
                              flat_.positions[face[2]].y()};
    const auto [low, high] = std::ranges::minmax(y);
    const bool across = high - low > 0.5F * length_mm_;
    std::array<bool, 3> is_past{};  // those past the end of the curve lie below its last
    for (std::size_t k = 0; k < 3; ++k) {
      is_past[k] = across && y[k] > -0.5F * length_mm_;
      y[k] -= is_past[k] ? length_mm_ : 0.0F;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      if (std::abs(y[next] - y[k]) >
          static_cast<float>(kRolloutMostStretch) * (true_mm[next] - true_mm[k]).norm()) {
        return;
      }
    }
    if (across) {
      cut(face, y, is_past);
    } else {
      flat_.faces.push_back(face);
    }
  }

 private:
  /// Two parts (Sutherland and Hodgman 1974): above the lower end, and past it, which is below the upper end.
  /// A corner at the very seam is past it where it was moved: its y does not tell.
  void cut(const Triangle& face, const std::array<float, 3>& y, const std::array<bool, 3>& is_past) {
    std::vector<std::uint32_t> above;
    std::vector<std::uint32_t> past;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      (is_past[k] ? past : above).push_back(face[k]);
      if (is_past[k] != is_past[next]) {
        const float rise = y[next] - y[k];
        const float t = rise != 0 ? std::clamp((-length_mm_ - y[k]) / rise, 0.0F, 1.0F) : 0.5F;
        above.push_back(between(face[k], face[next], t, -length_mm_));
        past.push_back(between(face[k], face[next], t, 0.0F));
      }
    }
    for (const auto* part : {&above, &past}) {
      for (std::size_t k = 2; k < part->size(); ++k) {
        flat_.faces.push_back({part->front(), (*part)[k - 1], (*part)[k]});
      }
    }
  }

  std::uint32_t between(std::uint32_t a, std::uint32_t b, float t, float y) {
    Eigen::Vector3f p = (1 - t) * flat_.positions[a] + t * flat_.positions[b];
    p.y() = y;
    const Eigen::Vector3f n = (1 - t) * flat_.normals[a] + t * flat_.normals[b];
    flat_.positions.push_back(p);
    flat_.normals.push_back(n.normalized());
    return static_cast<std::uint32_t>(flat_.positions.size() - 1);
  }

  Mesh& flat_;
  float length_mm_;
};

/// Sides meet where the curve looks between them.
std::array<RolloutSide, 4> sides_of(const SideCurve& curve) {
  const double d = std::sqrt(0.5);
  return {{{Face::kObverse, 0},
           {Face::kBottom, curve.along_facing_mm({-d, d})},
           {Face::kReverse, curve.along_facing_mm({-d, -d})},
           {Face::kTop, curve.along_facing_mm({d, -d})}}};
}

}  // namespace

ViewCamera rollout_camera() {
  return {Eigen::Matrix3d::Identity(), "rollout"};
}

Result<Rollout> rolled_out(const RenderScene& scene, const RigidTransform& tablet_from_model,
                           const JobContext& job) {
  const Mesh& mesh = scene.mesh();
  std::vector<std::uint8_t> used(mesh.positions.size(), 0);
  for (const auto& face : scene.faces()) {
    for (const std::uint32_t v : face) {
      used[v] = 1;
    }
  }
  std::vector<Eigen::Vector2f> side;
  side.reserve(mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (used[v] != 0) {
      side.push_back((tablet_from_model * mesh.positions[v].cast<double>()).tail<2>().cast<float>());
    }
  }
  const SideCurve curve(side);
  if (curve.empty()) {
    return bad_input("rollout", "the mesh has no surface to roll out", "scan and stitch first");
  }
  if (job.cancelled()) {
    return fail(ErrorKind::kCancelled, "stopped", "rollout");
  }
  Rollout rollout;
  rollout.sides = sides_of(curve);
  Mesh& flat = rollout.mesh;
  flat.positions.assign(mesh.positions.size(), Eigen::Vector3f::Zero());
  flat.normals.assign(mesh.positions.size(), Eigen::Vector3f::Zero());
  parallel_for_each_index(
      mesh.positions.size(),
      [&](std::size_t v) {
        if (used[v] == 0) {
          return;
        }
        const Eigen::Vector3d p = tablet_from_model * mesh.positions[v].cast<double>();
        const Eigen::Vector3d n = tablet_from_model.rotation * scene.normals()[v].cast<double>();
        const SideCurve::Place place = curve.place(p.tail<2>());
        flat.positions[v] = Eigen::Vector3d(p.x(), -place.along_mm, place.off_mm).cast<float>();
        // Upwards is against the way along the curve, which runs at a right angle to the left of `outward`.
        const Eigen::Vector2d up(place.outward.y(), -place.outward.x());
        flat.normals[v] =
            Eigen::Vector3d(n.x(), n.tail<2>().dot(up), n.tail<2>().dot(place.outward)).cast<float>();
      },
      kGrain);
  flat.faces.reserve(scene.faces().size());
  Laying laying(flat, curve.length_mm());
  for (const auto& face : scene.faces()) {
    laying.lay(face, {mesh.positions[face[0]], mesh.positions[face[1]], mesh.positions[face[2]]});
  }
  return rollout;
}

}  // namespace dubsar
