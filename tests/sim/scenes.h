// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <utility>

#include "core/mesh_query.h"
#include "sim/scene.h"
#include "sim/tablet.h"

namespace dubsar::sim {

/// A tablet small enough for tests, undamaged and without grain: what is measured on it is the wedges alone.
inline TabletOptions small_clean_tablet() {
  TabletOptions options;
  options.size_mm = {24, 20, 11};
  options.spacing_mm = 0.15;
  options.line_height_mm = 4.5;
  options.grain_um = 0;
  options.seal_um = 0;
  options.damage = DamageOptions::none();
  return options;
}

inline SimTablet make_or_fail(const TabletOptions& options) {
  JobContext job;
  Result<SimTablet> tablet = make_tablet(options, job);
  EXPECT_TRUE(tablet.has_value()) << tablet.error().line();
  return tablet ? std::move(*tablet) : SimTablet{};
}

inline void add_quad(SimTablet* tablet, const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                     const Eigen::Vector3f& c, const Eigen::Vector3f& d, float albedo) {
  Mesh& mesh = tablet->mesh;
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Eigen::Vector3f& p : {a, b, c, d}) {
    mesh.positions.push_back(p);
    tablet->albedo.push_back(albedo);
  }
  mesh.faces.push_back({base, base + 1, base + 2});
  mesh.faces.push_back({base, base + 2, base + 3});
  mesh.normals = vertex_normals(mesh);
}

/// A square in the plane z = z_mm, facing +z.
inline SimTablet plane(float half_mm, float z_mm, float albedo) {
  SimTablet tablet;
  add_quad(&tablet, {-half_mm, -half_mm, z_mm}, {half_mm, -half_mm, z_mm}, {half_mm, half_mm, z_mm},
           {-half_mm, half_mm, z_mm}, albedo);
  return tablet;
}

/// An open box of the size 2·half_x × 2·half_y standing on z = bottom, its top at z = top.
inline void add_block(SimTablet* tablet, float half_x, float half_y, float bottom, float top, float albedo) {
  const Eigen::Vector3f a(-half_x, -half_y, top);
  const Eigen::Vector3f b(half_x, -half_y, top);
  const Eigen::Vector3f c(half_x, half_y, top);
  const Eigen::Vector3f d(-half_x, half_y, top);
  const Eigen::Vector3f down(0, 0, bottom - top);
  add_quad(tablet, a, b, c, d, albedo);
  add_quad(tablet, a + down, b + down, b, a, albedo);
  add_quad(tablet, b + down, c + down, c, b, albedo);
  add_quad(tablet, c + down, d + down, d, c, albedo);
  add_quad(tablet, d + down, a + down, a, d, albedo);
}

/// Keeps a tablet, its query and a scene of the two together.
struct TestScene {
  SimTablet tablet;
  MeshQuery query;
  Scene scene;
  explicit TestScene(SimTablet made) : tablet(std::move(made)), query(tablet.mesh) {
    scene.tablet = &tablet;
    scene.query = &query;
  }
};

}  // namespace dubsar::sim
