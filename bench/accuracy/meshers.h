// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "core/range_grid.h"
#include "core/rigid_transform.h"

namespace dubsar::bench {

/// Placed scans as other programs take them.
struct MesherInput {
  struct Scan {
    const RangeGrid* grid = nullptr;
    RigidTransform model_from_scanner;
    Mesh mesh;  ///< the grid's own triangles, model frame, with normals
  };
  std::vector<Scan> scans;
  double spacing_mm = 0;  ///< µ: the cell of those that have cells
};

/// A way from scans to one mesh; nothing where it could not be run.
struct Mesher {
  std::string name;
  std::function<std::optional<Mesh>(const MesherInput&)> run;
};

/// Screened Poisson, ball pivoting, TSDF. Only where the library was found (see bench/CMakeLists.txt).
[[nodiscard]] std::vector<Mesher> open3d_meshers(const std::vector<int>& poisson_depths);
/// VCG's volumetric merge through MeshLab; empty where there is no `meshlabserver`.
[[nodiscard]] std::vector<Mesher> vcg_meshers();

}  // namespace dubsar::bench
