// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/rollout.h"

#include <array>
#include <cmath>

#include "archive/side_curve.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

constexpr std::size_t kGrain = 1U << 12U;

}  // namespace

ViewCamera rollout_camera() {
  return {Eigen::Matrix3d::Identity(), "rollout"};
}

Result<Mesh> rolled_out(const RenderScene& scene, const RigidTransform& tablet_from_model,
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
  Mesh flat;
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
  const auto half = static_cast<float>(0.5 * curve.length_mm());
  flat.faces.reserve(scene.faces().size());
  for (const auto& face : scene.faces()) {
    const std::array<float, 3> y = {flat.positions[face[0]].y(), flat.positions[face[1]].y(),
                                    flat.positions[face[2]].y()};
    if (std::abs(y[0] - y[1]) < half && std::abs(y[1] - y[2]) < half && std::abs(y[2] - y[0]) < half) {
      flat.faces.push_back(face);
    }
  }
  return flat;
}

}  // namespace dubsar
