// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "bench/support/link_mesh.h"

namespace dubsar::bench {

/// The projection of points on a mesh near a vertex of it (P_p of seed 001, 4).
class LinkProjector {
 public:
  explicit LinkProjector(const LinkMesh& on);

  /// Where the line through p meets the triangles that have `near` or a neighbour of it as a corner: the
  /// place nearest to p, at most most_mm away.
  [[nodiscard]] std::optional<Eigen::Vector3f> along(const Eigen::Vector3f& p, const Eigen::Vector3f& line,
                                                     std::uint32_t near, float most_mm) const;

 private:
  template <class Visit>
  void for_each_face_near(std::uint32_t vertex, const Visit& visit) const;

  const LinkMesh* mesh_;
  std::vector<std::uint32_t> first_, faces_;  ///< by vertex: its faces
};

}  // namespace dubsar::bench
