// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/vertex_graph.h"

namespace dubsar {

/// What is known of every vertex of the mesh, all [V]; see analysis/surface_fields.h.
struct PatchSource {
  const VertexGraph* graph = nullptr;
  std::span<const std::array<std::uint32_t, 3>> faces;  ///< of the mesh
  std::span<const float> area_mm2;
  std::span<const Eigen::Vector3f> position;
  std::span<const Eigen::Vector3f> normal;
  std::span<const float> reliability;
  std::span<const float> height_mm;
  /// Whether triangles take their normals from the 1-rings of their corners: noise turns the normals of small
  /// triangles far, where it is small against them their own are the sharper ones.
  bool noisy = false;
};

/// What a vertex weighs in a fit. One that is not reliable at all is still most often where it should be;
/// around a steep face of a few triangles there may be no others.
[[nodiscard]] constexpr float fit_weight(float reliability) {
  return 0.2F + 0.8F * reliability;
}

/// A triangle of the mesh with all its vertices in a patch.
struct PatchTriangle {
  std::array<std::uint32_t, 3> vertex{};  ///< of the patch
  Eigen::Vector3f middle{0, 0, 0};
  Eigen::Vector3f n{0, 0, 1};  ///< unit, on the side of its vertices' normals
  float weight = 0;            ///< area times fit_weight() of its worst corner, mm²
  float height = 0;            ///< of its middle over the free surface, mm
};

/// Some vertices of a mesh, one basin's or a part of them, in a frame of their own: origin at the lowest
/// vertex, z along the normal of the free surface over them.
struct WedgePatch {
  Eigen::Vector3d origin{0, 0, 0};
  Eigen::Matrix3d model_from_patch;   ///< rotation
  std::vector<std::uint32_t> vertex;  ///< [N] of the mesh, in rising height, then the rim
  std::size_t inner = 0;              ///< how many are not of the rim, the ring of neighbours around
  std::vector<Eigen::Vector3f> p;     ///< [N]
  std::vector<Eigen::Vector3f> n;     ///< [N] unit
  std::vector<float> weight;          ///< [N] reliability
  std::vector<float> area;            ///< [N] mm² of the vertex
  std::vector<float> height;          ///< [N] over the free surface
  VertexGraph graph;                  ///< within the patch, without faces
  std::vector<PatchTriangle> triangles;
  double spacing_mm = 0;  ///< median edge
  double depth_mm = 0;    ///< of the lowest vertex
  [[nodiscard]] std::size_t size() const { return vertex.size(); }
  [[nodiscard]] Eigen::Vector3d to_model(const Eigen::Vector3d& local) const {
    return model_from_patch * local + origin;
  }
};

/// `vertices` in rising height, at least one; those next to them are added as the rim. `up`: unit normal of
/// the free surface over them. `slot`: [V] scratch of the calling thread, all -1 before and after.
[[nodiscard]] WedgePatch make_patch(const PatchSource& source, std::span<const std::uint32_t> vertices,
                                    const Eigen::Vector3d& up, std::vector<std::int32_t>* slot);

}  // namespace dubsar
