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
  float along_mm = 0;         ///< from p along its normal
  bool well_sampled = false;  ///< none of the corners is sparse
  std::uint8_t rim = 0;       ///< of the corner that is nearest to it
  float weight = 0;           ///< interpolated; 0 where the line misses the other scan's triangles
  float reliability = 0;      ///< interpolated
};

/// Where the line through p along `normal` meets the triangles around a sample. Along a line, not to the
/// nearest point: of a rough sheet the nearest point is the one that errs the same way as p, and averaging
/// with it takes away next to nothing of the noise.
class LineProjector {
 public:
  LineProjector(const StitchSurface& s, const Vector3f& p, const Vector3f& normal)
      : s_(&s), p_(p), n_(normal) {
    u_ = n_.unitOrthogonal();
    v_ = s.mirrored ? Vector3f(u_.cross(n_)) : Vector3f(n_.cross(u_));  // triangles run as their grid does
  }

  [[nodiscard]] Projection around(const GridSurface& surface, std::size_t nearest) {
    const int row = s_->scan.grid->row_of(nearest);
    const int col = s_->scan.grid->col_of(nearest);
    // The foot is nearly always in the one of the four cells at the nearest sample towards which p lies;
    // noise may carry it into another, or one further.
    const int likely_row = towards(nearest, row, surface.rows, surface.cols) ? row : row - 1;
    const int likely_col = towards(nearest, col, surface.cols, 1) ? col : col - 1;
    meet_cell(surface, likely_row, likely_col);
    for (const int ring : {0, 1}) {
      if (best_.weight > 0) {
        break;
      }
      for (int r = row - 1 - ring; r <= row + ring; ++r) {
        for (int c = col - 1 - ring; c <= col + ring; ++c) {
          const bool inner = r >= row - 1 && r <= row && c >= col - 1 && c <= col;
          if (inner == (ring == 0) && (r != likely_row || c != likely_col)) {
            meet_cell(surface, r, c);
          }
        }
      }
    }
    return best_;
  }

 private:
  /// Whether p lies beyond the nearest sample in the direction of growing rows (or columns): `at` of `count`,
  /// `stride` apart in the arrays.
  [[nodiscard]] bool towards(std::size_t nearest, int at, int count, int stride) const {
    const auto step = static_cast<std::size_t>(stride);
    const bool after = at + 1 < count && s_->usable[nearest + step] != 0;
    const bool before = at > 0 && s_->usable[nearest - step] != 0;
    const Vector3f along = (after ? s_->points[nearest + step] : s_->points[nearest]) -
                           (before ? s_->points[nearest - step] : s_->points[nearest]);
    return along.dot(p_ - s_->points[nearest]) >= 0;
  }

  void meet_cell(const GridSurface& surface, int row, int col) {
    if (row < 0 || col < 0 || row > surface.rows - 2 || col > surface.cols - 2) {
      return;
    }
    const std::uint8_t cell = s_->cells[surface.index(row, col)];
    if ((cell & kCellFirst) != 0) {
      meet(cell_triangle(surface, row, col, cell, 0));
    }
    if ((cell & kCellSecond) != 0) {
      meet(cell_triangle(surface, row, col, cell, 1));
    }
  }

  void meet(const std::array<std::size_t, 3>& t) {
    const Vector3f a = s_->points[t[0]] - p_;
    const Vector3f b = s_->points[t[1]] - p_;
    const Vector3f c = s_->points[t[2]] - p_;
    const float au = u_.dot(a), av = v_.dot(a);
    const float bu = u_.dot(b), bv = v_.dot(b);
    const float cu = u_.dot(c), cv = v_.dot(c);
    const float wa = bu * cv - bv * cu;
    const float wb = cu * av - cv * au;
    const float wc = au * bv - av * bu;
    const float sum = wa + wb + wc;
    // Seen from below, or from the side: another fold, or no way to tell where.
    if (!(sum > 0)) {
      return;
    }
    const float slack = kSlack * sum;
    if (wa < slack || wb < slack || wc < slack) {
      return;
    }
    const float inverse = 1.0F / sum;
    const float along = (wa * n_.dot(a) + wb * n_.dot(b) + wc * n_.dot(c)) * inverse;
    if (best_.weight > 0 && std::abs(along) >= std::abs(best_.along_mm)) {
      return;
    }
    best_.along_mm = along;
    best_.well_sampled = !s_->is_sparse(t[0]) && !s_->is_sparse(t[1]) && !s_->is_sparse(t[2]);
    best_.rim = std::min({s_->rim[t[0]], s_->rim[t[1]], s_->rim[t[2]]});
    // Variances of independent samples: Σ λ² / w.
    const float la = wa * inverse, lb = wb * inverse, lc = wc * inverse;
    best_.weight =
        1.0F / (la * la / s_->weight[t[0]] + lb * lb / s_->weight[t[1]] + lc * lc / s_->weight[t[2]]);
    best_.reliability = std::clamp(
        (wa * s_->reliability[t[0]] + wb * s_->reliability[t[1]] + wc * s_->reliability[t[2]]) * inverse,
        0.0F, 1.0F);
  }

  static constexpr float kSlack = -0.01F;  ///< so that no line slips through between two triangles
  const StitchSurface* s_;
  Vector3f p_, n_, u_, v_;
  Projection best_;
};

float square(float x) {
  return x * x;
}

/// The pose's error is one of displacement in space; a third of its square lies along any one direction.
float pose_sigma_mm(const StitchSurface& s) {
  return std::isfinite(s.scan.sigma_mm) ? static_cast<float>(s.scan.sigma_mm / std::sqrt(3.0)) : 0.0F;
}

/// How much of its say a sample keeps that is so far from the rim of its scan.
float faded(std::uint8_t rim, float feather) {
  if (feather <= 0) {
    return 1.0F;
  }
  // Never quite nothing: a sample that no other scan supports stays where it was measured.
  const float part = std::clamp((static_cast<float>(rim) - 1.0F) / feather, 0.0F, 1.0F);
  return std::max(part * part, 1e-4F);
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

double step_mm(const StitchSurface& a, const StitchSurface& b, double reach_mm) {
  constexpr double kMedianOfSigma = 0.6745;  // of the absolute value
  const double sigma_mm = std::max(mismatch_mm(a, b, reach_mm), mismatch_mm(b, a, reach_mm)) / kMedianOfSigma;
  const double noise2 = a.noise_mm * a.noise_mm + b.noise_mm * b.noise_mm;
  return sigma_mm > 0 ? std::sqrt(std::max(0.0, sigma_mm * sigma_mm - noise2)) : 0.0;
}

double feather_samples(const StitchSurface& a, const StitchSurface& b, double step_mm) {
  constexpr double kSamplesPerStep = 3.0;
  constexpr double kLeast = 2.0;
  const double samples = kSamplesPerStep * step_mm / std::min(a.spacing_mm, b.spacing_mm);
  return samples < kLeast ? 0.0 : std::min(samples, static_cast<double>(kMostRim - 1));
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
  out.sigma_mm.assign(n, 0);
  out.sparse.assign(n, 0);
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
      float shift_sum = 0;
      float shift2_sum = 0;
      float feather = 0;
      for (std::size_t k = 0; k < others.size(); ++k) {
        feather = pairs[k]->match[i] < 0 ? feather : std::max(feather, pairs[k]->feather);
      }
      float weight_sum = from.weight[i] * faded(from.rim[i], feather);
      float pose_sum = square(weight_sum * pose_sigma_mm(from));
      float doubt = 1.0F - from.reliability[i];
      bool sparse = from.is_sparse(i);
      int scans = 1;
      for (std::size_t k = 0; k < others.size(); ++k) {
        const std::int32_t j = pairs[k]->match[i];
        if (j < 0) {
          continue;
        }
        const Projection q =
            LineProjector(*others[k], p, from.normals[i]).around(surfaces[k], static_cast<std::size_t>(j));
        if (!(q.weight > 0) || std::abs(q.along_mm) > pairs[k]->reach_mm) {
          continue;
        }
        const float weight = q.weight * faded(q.rim, pairs[k]->feather);
        shift_sum += weight * q.along_mm;
        shift2_sum += weight * square(q.along_mm);
        pose_sum += square(weight * pose_sigma_mm(*others[k]));
        weight_sum += weight;
        doubt *= 1.0F - q.reliability;
        sparse = sparse && !q.well_sampled;
        ++scans;
      }
      const float shift_mm = shift_sum / weight_sum;
      out.points[i] = p + shift_mm * from.normals[i];
      // Weights are inverse variances: the disagreement is their chi-square.
      const float chi2 = std::max(0.0F, shift2_sum - weight_sum * shift_mm * shift_mm);
      const float excess = scans > 1 ? std::max(1.0F, chi2 / static_cast<float>(scans - 1)) : 1.0F;
      out.sigma_mm[i] = std::sqrt(excess / weight_sum + pose_sum / (weight_sum * weight_sum));
      out.reliability[i] =
          (1.0F - doubt) / (1.0F + square(out.sigma_mm[i] / static_cast<float>(from.spacing_mm)));
      out.sparse[i] = sparse ? 1 : 0;
      out.scans[i] = static_cast<std::uint8_t>(std::min(scans, 255));
    }
  });
  return out;
}

}  // namespace dubsar
