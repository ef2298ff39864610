// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh.h"
#include "core/mesh_query.h"
#include "sim/tablet.h"

namespace dubsar::bench {

/// Of all threads of this program: what counts where others use the machine too.
[[nodiscard]] double cpu_seconds();

[[nodiscard]] double rms(const std::vector<double>& values);
[[nodiscard]] double mean(const std::vector<double>& values);

/// [points] to the nearest place of a surface; most_mm where it is farther.
[[nodiscard]] std::vector<double> distances_mm(const std::vector<Eigen::Vector3f>& points,
                                               const MeshQuery& to, double most_mm);

/// Those of the values where `of` is not 0.
[[nodiscard]] std::vector<double> chosen(const std::vector<double>& values,
                                         const std::vector<std::uint8_t>& of);

[[nodiscard]] double share_within(const std::vector<double>& distances_mm, double mm);

/// 1 for points within 0.2 mm of a line in which two faces of a wedge meet, or a face and the surface around
/// it.
[[nodiscard]] std::vector<std::uint8_t> near_wedge_edge(const sim::SimTablet& truth,
                                                        const std::vector<Eigen::Vector3f>& points);

/// What `mesh check` looks for, in one line.
void print_topology(const Mesh& mesh);

}  // namespace dubsar::bench
