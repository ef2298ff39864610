// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/fusion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

struct Projection {
  Vector3f point{0, 0, 0};
  float distance2 = std::numeric_limits<float>::max();
  float weight = 0;       ///< interpolated
  float reliability = 0;  ///< interpolated
};

/// Foot of p on the plane of one triangle, when it lies inside (with a hair's tolerance).
void project_on(const StitchSurface& s, const std::array<std::size_t, 3>& t, const Vector3f& p,
                Projection& best) {
  const Vector3f& a = s.points[t[0]];
  const Vector3f ab = s.points[t[1]] - a;
  const Vector3f ac = s.points[t[2]] - a;
  const Vector3f ap = p - a;
  const Vector3f n = ab.cross(ac);
  const float n2 = n.squaredNorm();
  const float v = ap.cross(ac).dot(n) / n2;
  const float w = ab.cross(ap).dot(n) / n2;
  const float u = 1.0F - v - w;
  // Feet between two triangles of a ridge fall outside both by a little; they belong to either.
  constexpr float kSlack = -0.15F;
  if (u < kSlack || v < kSlack || w < kSlack) {
    return;
  }
  const float height = ap.dot(n);
  const float distance2 = height * height / n2;
  if (distance2 < best.distance2) {
    best.point = p - n * (height / n2);
    best.distance2 = distance2;
    best.weight = std::max(0.0F, u * s.weight[t[0]] + v * s.weight[t[1]] + w * s.weight[t[2]]);
    best.reliability =
        std::clamp(u * s.reliability[t[0]] + v * s.reliability[t[1]] + w * s.reliability[t[2]], 0.0F, 1.0F);
  }
}

Projection project_near(const StitchSurface& s, const GridSurface& surface, std::size_t nearest,
                        const Vector3f& p) {
  Projection best;
  const int row = s.scan.grid->row_of(nearest);
  const int col = s.scan.grid->col_of(nearest);
  for (int r = std::max(row - 1, 0); r <= std::min(row, surface.rows - 2); ++r) {
    for (int c = std::max(col - 1, 0); c <= std::min(col, surface.cols - 2); ++c) {
      const std::uint8_t cell = s.cells[surface.index(r, c)];
      if ((cell & kCellFirst) != 0) {
        project_on(s, cell_triangle(surface, r, c, cell, 0), p, best);
      }
      if ((cell & kCellSecond) != 0) {
        project_on(s, cell_triangle(surface, r, c, cell, 1), p, best);
      }
    }
  }
  return best;
}

/// Whether a surface element could face the scanner, with some leave for noise and for camera and laser
/// standing apart.
bool may_see(const ScannerView& view, const Vector3f& p, const Vector3f& normal) {
  constexpr float kMostSine = -0.2F;
  const Vector3f to_camera = view.camera_mm ? Vector3f((view.camera_mm->cast<float>() - p).normalized())
                                            : Vector3f(-view.direction.cast<float>());
  return normal.dot(to_camera) > kMostSine;
}

/// Goes from sample to sample of a grid towards a point: the neighbour of a point whose pair is known has its
/// pair a step or two away.
class Walker {
 public:
  explicit Walker(const StitchSurface& to) : to_(&to), rows_(to.scan.grid->rows), cols_(to.scan.grid->cols) {
    const auto near = static_cast<float>(1.25 * to.spacing_mm);
    near2_ = near * near;
  }

  /// The sample at which no neighbour is nearer, or -1 when it is so far that one of
  /// another fold of the surface may be nearer.
  [[nodiscard]] std::int64_t walk(std::size_t at, const Vector3f& p) const {
    constexpr int kMostSteps = 8;
    float best2 = (to_->points[at] - p).squaredNorm();
    for (int step = 0; step < kMostSteps; ++step) {
      const int row = static_cast<int>(at / static_cast<std::size_t>(cols_));
      const int col = static_cast<int>(at % static_cast<std::size_t>(cols_));
      std::size_t next = at;
      for (int r = std::max(row - 1, 0); r <= std::min(row + 1, rows_ - 1); ++r) {
        for (int c = std::max(col - 1, 0); c <= std::min(col + 1, cols_ - 1); ++c) {
          const std::size_t i =
              static_cast<std::size_t>(r) * static_cast<std::size_t>(cols_) + static_cast<std::size_t>(c);
          if (to_->usable[i] != 0) {
            const float d2 = (to_->points[i] - p).squaredNorm();
            if (d2 < best2) {
              best2 = d2;
              next = i;
            }
          }
        }
      }
      if (next == at) {
        return best2 <= near2_ ? static_cast<std::int64_t>(at) : -1;
      }
      at = next;
    }
    return -1;
  }

 private:
  const StitchSurface* to_;
  int rows_, cols_;
  float near2_ = 0;
};

}  // namespace

double mismatch_mm(const StitchSurface& from, const StitchSurface& to, double reach_mm) {
  constexpr std::size_t kProbes = 1500;
  const std::size_t n = from.points.size();
  const std::size_t step = std::max<std::size_t>(1, n / kProbes) | 1U;
  Eigen::AlignedBox3f box = to.box;
  if (box.isEmpty()) {
    return -1;
  }
  box.min().array() -= static_cast<float>(reach_mm);
  box.max().array() += static_cast<float>(reach_mm);
  std::vector<float> distances;
  const Eigen::Matrix3f rotation = to.scanner_from_model.rotation.cast<float>();
  const Vector3f shift = to.scanner_from_model.translation_mm.cast<float>();
  for (std::size_t i = 0; i < n; i += step) {
    if (from.usable[i] == 0 || !box.contains(from.points[i]) ||
        !may_see(to.view, from.points[i], from.normals[i])) {
      continue;
    }
    const std::int64_t j =
        to.lookup->nearest(rotation * from.points[i] + shift, static_cast<float>(reach_mm));
    if (j < 0) {
      continue;
    }
    const auto q = static_cast<std::size_t>(j);
    if (from.normals[i].dot(to.normals[q]) > 0.9F) {
      distances.push_back(std::abs((from.points[i] - to.points[q]).dot(to.normals[q])));
    }
  }
  if (distances.size() < 8) {
    return -1;
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

double pair_reach_mm(const StitchSurface& a, const StitchSurface& b, const PairingOptions& options) {
  const double spacing = std::max(a.spacing_mm, b.spacing_mm);
  const double sigma = std::hypot(a.scan.sigma_mm, b.scan.sigma_mm);
  const double plain =
      options.reach_factor * spacing + (std::isfinite(sigma) ? options.sigma_factor * sigma : 0.0);
  const double most = std::max(plain, options.most_reach_factor * spacing);
  const double measured = std::max(mismatch_mm(a, b, most), mismatch_mm(b, a, most));
  // The median of a half-normal is 0.67 sigma: four medians reach 2.7 sigma; tangential offsets come on top.
  return std::clamp(4.0 * measured + spacing, plain, most);
}

Pairs find_pairs(const StitchSurface& from, const StitchSurface& to, double reach_mm,
                 const PairingOptions& options) {
  Pairs pairs;
  pairs.other_id = to.scan.id;
  pairs.reach_mm = static_cast<float>(reach_mm);
  pairs.match.assign(from.points.size(), -1);
  Eigen::AlignedBox3f box = to.box;
  if (box.isEmpty()) {
    return pairs;
  }
  box.min().array() -= pairs.reach_mm;
  box.max().array() += pairs.reach_mm;
  const Eigen::Matrix3f rotation = to.scanner_from_model.rotation.cast<float>();
  const Vector3f shift = to.scanner_from_model.translation_mm.cast<float>();
  const auto min_cos = static_cast<float>(options.min_normal_cos);
  constexpr float kLookAhead = 4.0F;
  const Walker walker(to);
  const auto cols = static_cast<std::size_t>(from.scan.grid->cols);
  pairs.count = parallel_reduce_ordered(
      static_cast<std::size_t>(from.scan.grid->rows), 8, std::size_t{0},
      [&](std::size_t begin, std::size_t end) {
        std::size_t count = 0;
        for (std::size_t row = begin; row < end; ++row) {
          std::int64_t last = -1;
          // Around `bare` no sample lies within the reach of anything nearer than `bare_mm` to it.
          Vector3f bare = Vector3f::Zero();
          float bare_mm = 0;
          for (std::size_t i = row * cols; i < (row + 1) * cols; ++i) {
            // A scan cannot have seen what faces away from it.
            if (from.usable[i] == 0 || !box.contains(from.points[i]) ||
                !may_see(to.view, from.points[i], from.normals[i])) {
              continue;
            }
            std::int64_t j = last < 0 ? -1 : walker.walk(static_cast<std::size_t>(last), from.points[i]);
            if (j < 0) {
              if (bare_mm > 0 && (from.points[i] - bare).squaredNorm() < bare_mm * bare_mm) {
                last = -1;
                continue;
              }
              const Vector3f p = rotation * from.points[i] + shift;
              j = to.lookup->nearest(p, pairs.reach_mm);
              if (j < 0) {
                const float around_mm = kLookAhead * pairs.reach_mm;
                const std::int64_t next = to.lookup->nearest(p, around_mm);
                const float clear_mm =
                    next < 0 ? around_mm : (to.scan.grid->point(static_cast<std::size_t>(next)) - p).norm();
                bare = from.points[i];
                // Rounding is far below a hundredth of the reach.
                bare_mm = clear_mm - 1.01F * pairs.reach_mm;
              }
            }
            last = j;
            if (j >= 0 && from.normals[i].dot(to.normals[static_cast<std::size_t>(j)]) > min_cos) {
              pairs.match[i] = static_cast<std::int32_t>(j);
              ++count;
            }
          }
        }
        return count;
      },
      [](std::size_t& total, std::size_t part) { total += part; });
  if (pairs.count == 0) {
    pairs.match.clear();
  }
  return pairs;
}

FusedSamples fuse(const StitchSurface& from, std::span<const StitchSurface* const> others,
                  std::span<const Pairs* const> pairs) {
  FusedSamples out;
  const std::size_t n = from.points.size();
  out.points = from.points;
  out.reliability = from.reliability;
  out.scans.assign(n, 0);
  std::vector<GridSurface> surfaces;
  surfaces.reserve(others.size());
  for (const StitchSurface* other : others) {
    surfaces.push_back(other->surface());
  }
  parallel_chunks(n, 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (from.usable[i] == 0) {
        continue;
      }
      const Vector3f& p = from.points[i];
      Vector3f shift_sum = Vector3f::Zero();
      float weight_sum = from.weight[i];
      float doubt = 1.0F - from.reliability[i];
      int scans = 1;
      for (std::size_t k = 0; k < others.size(); ++k) {
        const std::int32_t j = pairs[k]->match[i];
        if (j < 0) {
          continue;
        }
        const Projection q = project_near(*others[k], surfaces[k], static_cast<std::size_t>(j), p);
        if (q.distance2 > pairs[k]->reach_mm * pairs[k]->reach_mm) {
          continue;
        }
        shift_sum += q.weight * (q.point - p);
        weight_sum += q.weight;
        doubt *= 1.0F - q.reliability;
        ++scans;
      }
      out.points[i] = p + shift_sum / weight_sum;
      out.reliability[i] = 1.0F - doubt;
      out.scans[i] = static_cast<std::uint8_t>(std::min(scans, 255));
    }
  });
  return out;
}

}  // namespace dubsar
