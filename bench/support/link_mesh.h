// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/placed_scan.h"

namespace dubsar::bench {

/// A mesh as seed 001, 4 stitches it: one scan's own, or what several were merged to. Model frame, mm. Arrays
/// are [V] where nothing else is said.
struct LinkMesh {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;  ///< unit, out of the clay, of the scan that the vertex is of
  /// Unit, against the ray on which that scan measured the vertex: across it lies "the scanner plane" of the
  /// seed, in which a grid's own links never fold, for a sample errs along its ray.
  std::vector<Eigen::Vector3f> to_scanner;
  std::vector<float> reliability;  ///< R of that scan, 1 / mm
  std::vector<float> weight;       ///< R of all that its position is the average of, together
  std::vector<std::array<std::uint32_t, 3>> faces;  ///< [F], counter-clockwise from outside
};

/// The vertices that share an edge with each of V, in no order, and which vertices have an open link.
struct Neighbours {
  std::vector<std::uint32_t> first;       ///< [V + 1], into others
  std::vector<std::uint32_t> others;      ///< by vertex, ascending
  std::vector<std::uint8_t> is_boundary;  ///< [V], 1 where one of its edges has one face
};
[[nodiscard]] Neighbours neighbours_of(const LinkMesh& mesh);

/// The triangles of one grid's samples that are not sparse. R is that of seed 001, 3.2: the mean of one over
/// the distance to each neighbour. That is taken over `smoothing` rings of neighbours again, for the noise of
/// single samples would have the more reliable scan change from sample to sample.
[[nodiscard]] LinkMesh link_mesh(const PlacedScan& scan, int smoothing);

}  // namespace dubsar::bench
