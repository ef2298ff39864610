// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/point_spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>

#include "core/order_statistics.h"

namespace dubsar {

namespace {

constexpr std::size_t kProbes = 20000;
/// Points looked at per probe: bounds the time for clouds with most points in a few cells.
constexpr int kMostLooks = 4096;
constexpr int kWidestRing = 8;
/// Directions that agree less than this are those of a random cloud.
constexpr double kShared = 0.4;
/// Fewer points than this do not fill enough of the wider cells.
constexpr std::size_t kFewPoints = 4096;
constexpr std::int64_t kCellBits = 21;
constexpr std::int64_t kCellMiddle = std::int64_t{1} << (kCellBits - 1);

using Cell = std::array<std::int64_t, 3>;

/// Points in cells of a cube lattice, sorted; x varies fastest so that three cells in a row are one range.
class CubeCells {
 public:
  CubeCells(const std::vector<Eigen::Vector3f>& points, double size_mm) : points_(points), size_mm_(size_mm) {
    sorted_.reserve(points.size());
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      sorted_.push_back({key(cell_of(points[i])), i});
    }
    std::ranges::sort(sorted_);
  }

  /// From p to the nearest point at another place; zero when there is none near.
  [[nodiscard]] Eigen::Vector3d to_nearest(const Eigen::Vector3f& p) const {
    const Cell at = cell_of(p);
    int looks = 0;
    for (int ring = 1; ring <= kWidestRing; ring *= 2) {
      double best = std::numeric_limits<double>::max();
      Eigen::Vector3d way = Eigen::Vector3d::Zero();
      for (std::int64_t dz = -ring; dz <= ring; ++dz) {
        for (std::int64_t dy = -ring; dy <= ring; ++dy) {
          const std::uint64_t from = key({at[0] - ring, at[1] + dy, at[2] + dz});
          const std::uint64_t to = key({at[0] + ring, at[1] + dy, at[2] + dz});
          auto entry = std::ranges::lower_bound(sorted_, from, {}, &Entry::key);
          for (; entry != sorted_.end() && entry->key <= to && looks < kMostLooks; ++entry, ++looks) {
            const Eigen::Vector3d step = (points_[entry->point] - p).cast<double>();
            if (const double distance = step.norm(); distance > 0 && distance < best) {
              best = distance;
              way = step;
            }
          }
        }
      }
      // A nearer one cannot lie outside the ring; when the looks are spent, this is the best bound there is.
      if (best <= ring * size_mm_ || (looks >= kMostLooks && best < std::numeric_limits<double>::max())) {
        return way;
      }
    }
    return Eigen::Vector3d::Zero();
  }

 private:
  struct Entry {
    std::uint64_t key;
    std::uint32_t point;
    auto operator<=>(const Entry&) const = default;
  };
  [[nodiscard]] Cell cell_of(const Eigen::Vector3f& p) const {
    Cell out;
    for (int k = 0; k < 3; ++k) {
      const double cell = std::floor(static_cast<double>(p[k]) / size_mm_) + static_cast<double>(kCellMiddle);
      // Room for the widest ring at either end.
      out[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(
          std::clamp(cell, static_cast<double>(kWidestRing),
                     static_cast<double>((std::int64_t{1} << kCellBits) - 1 - kWidestRing)));
    }
    return out;
  }
  [[nodiscard]] static std::uint64_t key(const Cell& cell) {
    return static_cast<std::uint64_t>((((cell[2] << kCellBits) | cell[1]) << kCellBits) | cell[0]);
  }

  const std::vector<Eigen::Vector3f>& points_;
  double size_mm_;
  std::vector<Entry> sorted_;
};

/// The width of each axis without the outermost hundredth at either end, widest first.
std::array<double, 3> widths(const std::vector<Eigen::Vector3f>& points) {
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kProbes);
  std::array<double, 3> out{};
  for (int k = 0; k < 3; ++k) {
    std::vector<float> values;
    for (std::size_t i = 0; i < points.size(); i += stride) {
      values.push_back(points[i][k]);
    }
    std::ranges::sort(values);
    const std::size_t cut = values.size() / 100;
    out[static_cast<std::size_t>(k)] = static_cast<double>(values[values.size() - 1 - cut]) - values[cut];
  }
  std::ranges::sort(out, std::greater<>());
  return out;
}

}  // namespace

NeighbourStatistics nearest_neighbours(const std::vector<Eigen::Vector3f>& points) {
  NeighbourStatistics out;
  if (points.size() < 2) {
    return out;
  }
  const std::array<double, 3> width = widths(points);
  const auto n = static_cast<double>(points.size());
  // A surface covers about the product of its two widest extents; a line or a spot has at least its length.
  const double guess = std::max(std::sqrt(width[0] * width[1] / n), width[0] / n);
  if (!(guess > 0)) {
    return out;
  }
  const CubeCells cells(points, guess);
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kProbes);
  std::vector<double> distances;
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const Eigen::Vector3d step = cells.to_nearest(points[i]);
    if (const double distance = step.norm(); distance > 0) {
      distances.push_back(distance);
      // Four times the angle: quarter turns fall together.
      sum += std::polar(1.0, 4.0 * std::atan2(step.y(), step.x()));
    }
  }
  if (distances.empty()) {
    return out;
  }
  if (std::abs(sum) > kShared * static_cast<double>(distances.size())) {
    out.lattice_rad = std::arg(sum) / 4.0;
  }
  out.median_mm = median_of(std::move(distances));
  return out;
}

double even_spacing_mm(const std::vector<Eigen::Vector3f>& points, double nearest_mm) {
  if (!(nearest_mm > 0) || points.empty()) {
    return 0.0;
  }
  const double cell = (points.size() < kFewPoints ? 4.0 : 8.0) * nearest_mm;
  std::vector<std::pair<std::int64_t, std::int64_t>> occupied;
  occupied.reserve(points.size());
  for (const Eigen::Vector3f& p : points) {
    occupied.emplace_back(static_cast<std::int64_t>(std::floor(p.y() / cell)),
                          static_cast<std::int64_t>(std::floor(p.x() / cell)));
  }
  std::ranges::sort(occupied);
  // The points per cell that the median point finds around it: the half-filled cells of the border and stray
  // points do not count.
  std::vector<std::size_t> per_point;
  per_point.reserve(points.size());
  for (std::size_t i = 0; i < occupied.size();) {
    std::size_t end = i;
    while (end < occupied.size() && occupied[end] == occupied[i]) {
      ++end;
    }
    per_point.insert(per_point.end(), end - i, end - i);
    i = end;
  }
  return cell / std::sqrt(static_cast<double>(median_of(std::move(per_point))));
}

}  // namespace dubsar
