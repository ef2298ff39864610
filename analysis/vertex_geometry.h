// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "analysis/mesh_parts.h"
#include "analysis/vertex_graph.h"
#include "core/mesh.h"

namespace dubsar {

/// What the surface is at each vertex.
struct VertexGeometry {
  std::vector<Eigen::Vector3f> normal;  ///< [V] unit, area-weighted, out of the clay; zero without an area
  std::vector<float> area_mm2;          ///< [V] a third of its faces'
  double mean_edge_mm = 0;              ///< of the edges of the graph
  double total_area_mm2 = 0;
  /// Half the vertices lie within 2/3 of this of the middle of their neighbours, along the normal: the noise
  /// of a scan, or how rough the clay is at the scale of the mesh.
  double roughness_mm = 0;
  MeshParts parts;  ///< that hang together; empty without an area
  /// Around the vertices with an area, but for those of scraps: parts of the mesh with less than a thousandth
  /// of its area, as long as they are not most of it. Wherever one lies, it must not move the grids. And but
  /// for the few (1 in 1000 on a side) that lie off by more than a twentieth of the rest, which must not
  /// decide how fine a grid around a tablet is.
  Eigen::AlignedBox3f box;
  bool turned = false;  ///< the faces by and large run clockwise seen from outside; the normals were turned
};

/// A face that lies against its fellows at a vertex is turned there. Which side is out: the side that the
/// mesh, or a large part apart from it, bulges to, seen from its centre; untold (a flat scan): the file's.
[[nodiscard]] VertexGeometry make_vertex_geometry(const Mesh& mesh, const VertexGraph& graph);

}  // namespace dubsar
