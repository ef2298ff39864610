// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <vector>

#include "analysis/surface_fields.h"
#include "analysis/wedge_measure.h"
#include "analysis/wedges.h"
#include "core/mesh.h"

namespace dubsar {

/// mm² of the surface that each vertex stands for, [V].
[[nodiscard]] std::vector<float> vertex_areas(const Mesh& mesh, const VertexGraph& graph);
/// Of those that are of any face.
[[nodiscard]] double mean_area_mm2(const std::vector<float>& areas);
/// Edge of the equilateral triangle that the mean vertex stands for.
[[nodiscard]] double mean_spacing_mm(const std::vector<float>& areas);

/// Whether noise of the heights (analysis/height_noise.h) turns the normals of triangles of this size far.
[[nodiscard]] bool is_noisy(double noise_mm, const std::vector<float>& areas);

/// Measures hollows of one mesh. What it is made from must outlive it. Of any thread.
class HollowMeasure {
 public:
  /// `noisy`: is_noisy() of the body that the hollows are in.
  HollowMeasure(const Mesh& mesh, const VertexGraph& graph, const SurfaceFields& fields,
                const WedgeOptions& options, const std::vector<float>& areas, bool noisy);

  /// The wedge of a hollow: faces, edges, measures. `vertices`: those of the hollow, the one nearest to the
  /// depth point first. What is wrong where there is none. `slot`: [V] scratch of the calling thread, all -1
  /// before and after. `open`, where given, gets the parts of the hollow that the wedge does not explain.
  [[nodiscard]] std::expected<WedgeCandidate, std::string> measure(
      std::span<const std::uint32_t> vertices, std::vector<std::int32_t>* slot,
      std::vector<std::vector<std::uint32_t>>* open = nullptr) const;

  /// Every wedge of a basin, and what was taken for one at first, or was not looked at after four of them.
  /// `vertices` in rising height.
  [[nodiscard]] std::vector<WedgeCandidate> look_at(std::span<const std::uint32_t> vertices,
                                                    std::vector<std::int32_t>* slot) const;

  /// Fewer cannot be told from noise.
  [[nodiscard]] std::size_t least_vertices() const;

 private:
  [[nodiscard]] Eigen::Vector3d up_over(std::span<const std::uint32_t> vertices) const;
  void note_ends_in_air(const HeightSurface& surface, double spacing_mm, WedgeCandidate* found) const;

  const Mesh& mesh_;
  const SurfaceFields& fields_;
  const WedgeOptions& options_;
  const std::vector<float>& areas_;
  PatchSource source_;
};

}  // namespace dubsar
