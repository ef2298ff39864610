// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/body_fields.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "analysis/mesh_bodies.h"
#include "analysis/vertex_geometry.h"
#include "analysis/vertex_graph.h"

namespace dubsar {
namespace {

using Eigen::Vector3f;

/// 1: it lies so far off that the height maps, which hold all that is drawn, would grow by the way to it. [V]
std::vector<std::uint8_t> lies_off(const Mesh& body, double radius_mm) {
  Eigen::AlignedBox3f box = make_vertex_geometry(body, make_vertex_graph(body)).box;
  std::vector<std::uint8_t> off(body.positions.size(), 1);
  if (box.isEmpty()) {
    return off;
  }
  constexpr float kTip = 0.25F;  // of its size: the box leaves out a tip of few vertices, too
  const Vector3f about = Vector3f::Constant(static_cast<float>(radius_mm) + kTip * box.diagonal().norm());
  box = {box.min() - about, box.max() + about};
  std::ranges::transform(body.positions, off.begin(),
                         [&](const Vector3f& p) { return static_cast<std::uint8_t>(!box.contains(p)); });
  return off;
}

std::vector<Vector3f> picked(const std::vector<Vector3f>& all, const std::vector<std::uint32_t>& which) {
  std::vector<Vector3f> out(which.size());
  std::ranges::transform(which, out.begin(), [&](std::uint32_t v) { return all[v]; });
  return out;
}

}  // namespace

std::vector<float> openness_of_bodies(const Mesh& mesh, const VertexGeometry& geometry,
                                      const OpennessOptions& options, const JobContext& job) {
  const std::vector<std::uint8_t> body_of = find_bodies(mesh, geometry).of;
  if (body_of.empty()) {
    return vertex_openness(mesh, geometry, options, job);
  }
  return of_each_body(mesh, body_of, [&](const Mesh& body) {
    return vertex_openness(body, make_vertex_geometry(body, make_vertex_graph(body)), options, job);
  });
}

IntegralInvariants invariants_of_bodies(const Mesh& mesh, const std::vector<std::uint8_t>& body_of,
                                        const std::vector<Vector3f>& outlook, double mean_edge_mm,
                                        const IntegralInvariantOptions& options, const JobContext& job) {
  IntegralInvariants all;
  /// Of a mesh whose vertices are these of the whole one. False when cancelled.
  const auto add = [&](const Mesh& part, const std::vector<std::uint32_t>& vertex) {
    const IntegralInvariants some =
        integral_invariants(part, picked(outlook, vertex), mean_edge_mm, options, job);
    if (some.radii_mm.empty()) {
      return false;
    }
    const std::size_t scales = some.radii_mm.size();
    all.radii_mm = some.radii_mm;
    all.resolved_mm = some.resolved_mm;
    all.value.resize(mesh.positions.size() * scales, 0.0F);
    for (std::size_t i = 0; i < vertex.size(); ++i) {
      std::copy_n(&some.value[i * scales], scales, &all.value[vertex[i] * scales]);
    }
    return true;
  };
  if (body_of.empty()) {
    const std::vector<std::uint8_t> off = lies_off(mesh, options.radius_mm);
    if (std::ranges::count(off, 1) == 0) {
      return integral_invariants(mesh, outlook, mean_edge_mm, options, job);
    }
    const BodyMesh near = body_mesh(mesh, off, 0);
    return add(near.mesh, near.vertex) ? all : IntegralInvariants{};
  }
  const std::size_t bodies = std::size_t{1} + *std::ranges::max_element(body_of);
  for (std::size_t b = 0; b < bodies; ++b) {
    BodyMesh body = body_mesh(mesh, body_of, b);
    const std::vector<std::uint8_t> off = lies_off(body.mesh, options.radius_mm);
    if (std::ranges::count(off, 1) != 0) {
      BodyMesh near = body_mesh(body.mesh, off, 0);
      for (std::uint32_t& v : near.vertex) {
        v = body.vertex[v];
      }
      body = std::move(near);
    }
    if (!add(body.mesh, body.vertex)) {
      return {};
    }
  }
  return all;
}

}  // namespace dubsar
