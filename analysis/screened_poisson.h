// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "analysis/node_grid.h"
#include "core/job.h"

namespace dubsar {

/// An oriented point of the surface to be reconstructed; z_cell ascending over all samples.
struct PoissonSample {
  Eigen::Vector3f position_mm{0, 0, 0};
  Eigen::Vector3f area_normal_mm2{0, 0, 0};  ///< out of the body, as long as the area it stands for
  float pin_mm2 = 0;                         ///< how strongly the surface is held to the point: an area too
};

struct PoissonOptions {
  float screening = 4.0F;   ///< α of Kazhdan and Hoppe 2013, per cell: 0 leaves only the gradient field
  double tolerance = 1e-4;  ///< residual to right side
  int most_iterations = 40;
};

/// The indicator of a body, about +½ inside and −½ outside, 0 at the samples.
struct Indicator {
  std::vector<float> value;  ///< [nodes]; empty when there was nothing to solve or the job was cancelled
  int iterations = 0;
  double residual = 0;  ///< to the right side
};

/// Screened Poisson reconstruction (Kazhdan, Hoppe 2013) on one regular grid: min ∫|∇χ − V|² + α Σ pin χ(p)²,
/// V the inward normals spread over the edges of the grid by the quadratic B-spline. Conjugate gradients
/// preconditioned by Multigrid. Samples outside the grid are left out. Deterministic for any number of
/// threads.
[[nodiscard]] Indicator solve_screened_poisson(std::span<const PoissonSample> samples, const NodeGrid& grid,
                                               const PoissonOptions& options, const JobContext& job);

}  // namespace dubsar
