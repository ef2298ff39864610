// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "triangulation/owned_scan.h"

namespace dubsar {

/// By node: which of a scan's pairs keep something that samples of the node may have to do with: 1 near it, 2
/// right where it is.
struct Contest {
  std::vector<std::vector<std::uint8_t>> by_pair;
  std::vector<std::uint8_t> any;  ///< 1 where one of them does
};
[[nodiscard]] Contest contest_of(const std::vector<OwnedScan>& scans, std::size_t self);

/// Nodes of another scan within which the pairs of one node's samples lie.
[[nodiscard]] int reach_nodes(const StitchSurface& s, const StitchSurface& other);

/// What the other scans keep around the samples of one node after another. The pairs that one question needs
/// are there for the next: samples of a node ask for the same, and six triangles share a corner. One for each
/// thread.
class NodeContest {
 public:
  NodeContest(const std::vector<OwnedScan>& scans, std::size_t self, const Contest& contest,
              const OwnershipOptions& options);

  /// What is asked from now on is of this node. Costs nothing until something is.
  void enter(std::size_t node) {
    node_ = node;
    is_laid_out_ = false;
  }

  /// True when sample i of the node lies within the clearance of, or inside, what another scan keeps.
  [[nodiscard]] bool is_taken(std::size_t i);

  /// True when a triangle of another scan's patch meets the triangle t of this one, seen along its normal.
  /// Its first corner is of the node, the others within a sample of it. `points`: this scan's, [rows*cols].
  [[nodiscard]] bool meets_another(std::span<const Eigen::Vector3f> points,
                                   const std::array<std::size_t, 3>& t);

 private:
  static constexpr std::size_t kNoPair = ~std::size_t{0};
  /// Forgets what is known of the node before.
  void lay_out();
  [[nodiscard]] const StitchSurface& other_surface(std::size_t k) const;
  [[nodiscard]] const PairStart& start(std::size_t k, std::size_t sample);
  [[nodiscard]] std::int64_t pair(std::size_t k, std::size_t sample);
  [[nodiscard]] bool is_taken_by(std::size_t k, std::size_t i);
  /// Whether what the k-th pair's scan keeps lies near one of a triangle's corners.
  [[nodiscard]] bool is_near(std::size_t k, const std::array<std::size_t, 3>& t);

  const std::vector<OwnedScan>* scans_;
  const OwnedScan* scan_;
  const Contest* contest_;
  const OwnershipOptions* options_;
  std::size_t node_ = 0;
  bool is_laid_out_ = false;          ///< what follows is of this node
  int row_ = 0, col_ = 0;             ///< the node's first sample
  std::size_t last_taker_ = kNoPair;  ///< the pair that took the sample that was taken last
  std::vector<PairStart> starts_;     ///< by pair, of the node and the three after it
  std::vector<std::uint8_t> start_known_;
  std::vector<std::int32_t> pair_;  ///< by pair and sample, of the node's and those just after them
};

}  // namespace dubsar
