// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/link_pairs.h"

#include <Eigen/Geometry>
#include <bit>
#include <cmath>

#include "core/parallel.h"

namespace dubsar::bench {

namespace {

using Eigen::Vector3f;

constexpr float kMinNormalCos = 0.5F;

/// Points by cells of space, the cells in a table of buckets: what else falls into a bucket is too far away.
class Cells {
 public:
  Cells(const std::vector<Vector3f>& points, float cell_mm)
      : points_(&points), per_mm_(1.0F / cell_mm), first_(std::bit_ceil(points.size() + 1) + 1) {
    for (const Vector3f& p : points) {
      ++first_[bucket(place(p)) + 1];
    }
    for (std::size_t b = 1; b < first_.size(); ++b) {
      first_[b] += first_[b - 1];
    }
    std::vector<std::uint32_t> at(first_.begin(), first_.end() - 1);
    entries_.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      entries_[at[bucket(place(points[i]))]++] = static_cast<std::uint32_t>(i);
    }
  }

  /// Of those within a cell's length that are accepted.
  template <class Accept>
  [[nodiscard]] std::int64_t closest(const Vector3f& p, const Accept& accept) const {
    float best = 1.0F / (per_mm_ * per_mm_);
    std::int64_t out = -1;
    const Eigen::Vector3i middle = place(p);
    for (int n = 0; n < 27; ++n) {
      const std::size_t b = bucket(middle + Eigen::Vector3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1));
      for (std::uint32_t k = first_[b]; k < first_[b + 1]; ++k) {
        const float d = ((*points_)[entries_[k]] - p).squaredNorm();
        if (d < best && accept(entries_[k])) {
          best = d;
          out = entries_[k];
        }
      }
    }
    return out;
  }

 private:
  [[nodiscard]] Eigen::Vector3i place(const Vector3f& p) const {
    return (p * per_mm_).array().floor().cast<int>();
  }
  [[nodiscard]] std::size_t bucket(const Eigen::Vector3i& cell) const {
    // Teschner et al. 2003, "Optimized spatial hashing for collision detection".
    const std::uint64_t h = static_cast<std::uint64_t>(cell.x()) * 73856093U ^
                            static_cast<std::uint64_t>(cell.y()) * 19349663U ^
                            static_cast<std::uint64_t>(cell.z()) * 83492791U;
    return (h ^ h >> 20U) & (first_.size() - 2);
  }

  const std::vector<Vector3f>* points_;
  float per_mm_;
  std::vector<std::uint32_t> first_, entries_;
};

}  // namespace

std::vector<std::int64_t> closest_vertices(const LinkMesh& from, const LinkMesh& to, const LinkReach& reach) {
  const Cells cells(to.positions, reach.all_mm);
  std::vector<std::int64_t> out(from.positions.size());
  parallel_for_each_index(out.size(), [&](std::size_t v) {
    out[v] = cells.closest(from.positions[v], [&](std::uint32_t w) {
      const Vector3f d = to.positions[w] - from.positions[v];
      return d.cross(from.to_scanner[v]).squaredNorm() <= reach.across_mm * reach.across_mm &&
             to.normals[w].dot(from.normals[v]) >= kMinNormalCos;
    });
  });
  return out;
}

}  // namespace dubsar::bench
