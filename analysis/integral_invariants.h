// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/job.h"
#include "core/mesh.h"

namespace dubsar {

struct IntegralInvariantOptions {
  double radius_mm = 1.0;  ///< R, the largest sphere: at least as large as the largest feature
  int octave = 4;          ///< n: 2ⁿ scales, 0 to 5
};

/// Multi-scale integral invariants (Mara, Krömker, Jakob, Breuckmann 2010; GigaMesh): how much of the sphere
/// about a vertex lies below the surface, f = 2·V_below / V_sphere − 1 in [−1, 1]: 0 on a plane, above 0 in a
/// valley, below 0 on a ridge.
struct IntegralInvariants {
  std::vector<float> radii_mm;  ///< [S], R(1 − i/2ⁿ), i = 0 … 2ⁿ−1
  double resolved_mm = 0;       ///< spheres smaller than this are as coarse as the map
  std::vector<float> value;     ///< [V × S], by vertex; 0 for a vertex without an outlook
};

/// outlook: [V] unit normals of the surface at large, out of the clay (those of the height surface serve
/// best; zero: none). Where GigaMesh rasters the patch of every vertex anew, the surface is drawn here into
/// one height map per direction of a few that cover the sphere, and a vertex reads the map that its outlook
/// is nearest to: the volume below a surface does not depend on the direction one sums it up in. Where a
/// sphere reaches beyond an end of the mesh, a border or a hole, f is that of the part over which there is
/// clay, so that a plane reads 0 up to its border; 0 where that is less than 15 %. Sphere radii below two
/// pixels of the map (the larger of R/16 and the mean edge) are as coarse as these. Empty when cancelled; the
/// same for any number of threads.
[[nodiscard]] IntegralInvariants integral_invariants(const Mesh& mesh,
                                                     const std::vector<Eigen::Vector3f>& outlook,
                                                     double mean_edge_mm,
                                                     const IntegralInvariantOptions& options,
                                                     const JobContext& job);

/// One value a vertex for the usual picture: the one of largest magnitude over the scales that are resolved.
/// [V]
[[nodiscard]] std::vector<float> strongest_response(const IntegralInvariants& invariants);

}  // namespace dubsar
