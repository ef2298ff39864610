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

  /// In one cell alone: the one that `first_sample` begins.
  [[nodiscard]] Projection in_cell(const GridSurface& surface, std::size_t first_sample) {
    meet_cell(surface, s_->lattice.sample_row(first_sample), s_->lattice.sample_col(first_sample));
    return best_;
  }

  [[nodiscard]] Projection around(const GridSurface& surface, std::size_t nearest) {
    const int row = s_->lattice.sample_row(nearest);
    const int col = s_->lattice.sample_col(nearest);
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
        1.0F / (la * la / s_->weight(t[0]) + lb * lb / s_->weight(t[1]) + lc * lc / s_->weight(t[2]));
    best_.reliability = std::clamp(
        (wa * s_->reliability(t[0]) + wb * s_->reliability(t[1]) + wc * s_->reliability(t[2])) * inverse,
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
  return std::isfinite(s.pose_sigma_mm) ? static_cast<float>(s.pose_sigma_mm / std::sqrt(3.0)) : 0.0F;
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

}  // namespace

FusedSamples::FusedSamples(const StitchSurface& of) : slot(of.points.size(), kNone) {}

void FusedSamples::forget_if(const std::function<bool(std::uint32_t)>& gone) {
  std::size_t out = 0;
  for (std::size_t at = 0; at < samples.size(); ++at) {
    const std::uint32_t i = samples[at];
    if (gone(i)) {
      slot[i] = kNone;
      continue;
    }
    slot[i] = static_cast<std::uint32_t>(out);
    samples[out] = i;
    points[out] = points[at];
    reliability[out] = reliability[at];
    sigma_mm[out] = sigma_mm[at];
    sparse[out] = sparse[at];
    scans[out++] = scans[at];
  }
  samples.resize(out);
  points.resize(out);
  reliability.resize(out);
  sigma_mm.resize(out);
  sparse.resize(out);
  scans.resize(out);
}

void fuse(const StitchSurface& from, std::span<const StitchSurface* const> others,
          std::span<const Pairs* const> pairs, std::span<const std::uint32_t> which, FusedSamples& out) {
  const std::size_t first = out.samples.size();
  out.samples.insert(out.samples.end(), which.begin(), which.end());
  const std::size_t n = out.samples.size();
  out.points.resize(n);
  out.reliability.resize(n);
  out.sigma_mm.resize(n);
  out.sparse.resize(n);
  out.scans.resize(n);
  std::vector<GridSurface> surfaces;
  surfaces.reserve(others.size());
  for (const StitchSurface* other : others) {
    surfaces.push_back(other->surface());
  }
  parallel_chunks(which.size(), 2048, [&](std::size_t begin, std::size_t end) {
    std::vector<std::pair<std::size_t, Projection>> found;
    std::vector<std::pair<std::size_t, PairStart>> starts;  // other, where to look, of one node
    std::size_t node = from.lattice.size();
    for (std::size_t at = first + begin; at < first + end; ++at) {
      const std::size_t i = out.samples[at];
      out.slot[i] = static_cast<std::uint32_t>(at);
      const Vector3f& p = from.points[i];
      const Vector3f normal = from.normal(i);
      if (from.lattice.node_of(i) != node) {
        node = from.lattice.node_of(i);
        starts.clear();
        for (std::size_t k = 0; k < others.size(); ++k) {
          if (const PairStart start = pair_start(from, node, *others[k], *pairs[k]); start.sample >= 0) {
            starts.emplace_back(k, start);
          }
        }
      }
      float feather = 0;
      found.clear();
      for (const auto& [k, start] : starts) {
        const StitchSurface& other = *others[k];
        LineProjector line(other, p, normal);
        Projection q;
        const std::int64_t cell = likely_cell(start, other, p);
        if (cell >= 0 &&
            normal.dot(other.normal(static_cast<std::size_t>(cell))) > pairs[k]->min_normal_cos) {
          q = line.in_cell(surfaces[k], static_cast<std::size_t>(cell));
        }
        if (!(q.weight > 0)) {
          const std::int64_t j = pair_of(from, i, start, other, *pairs[k]);
          if (j < 0) {
            continue;
          }
          q = line.around(surfaces[k], static_cast<std::size_t>(j));
        }
        if (q.weight > 0 && std::abs(q.along_mm) <= pairs[k]->reach_mm) {
          found.emplace_back(k, q);
        }
        feather = std::max(feather, pairs[k]->feather);
      }
      float shift_sum = 0;
      float shift2_sum = 0;
      float weight_sum = from.weight(i) * faded(from.rim[i], feather);
      float pose_sum = square(weight_sum * pose_sigma_mm(from));
      float doubt = 1.0F - from.reliability(i);
      bool sparse = from.is_sparse(i);
      int scans = 1;
      for (const auto& [k, q] : found) {
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
      out.points[at] = p + shift_mm * normal;
      // Weights are inverse variances: the disagreement is their chi-square.
      const float chi2 = std::max(0.0F, shift2_sum - weight_sum * shift_mm * shift_mm);
      const float excess = scans > 1 ? std::max(1.0F, chi2 / static_cast<float>(scans - 1)) : 1.0F;
      out.sigma_mm[at] = std::sqrt(excess / weight_sum + pose_sum / (weight_sum * weight_sum));
      out.reliability[at] =
          (1.0F - doubt) / (1.0F + square(out.sigma_mm[at] / static_cast<float>(from.spacing_mm)));
      out.sparse[at] = sparse ? 1 : 0;
      out.scans[at] = static_cast<std::uint8_t>(std::min(scans, 255));
    }
  });
}

}  // namespace dubsar
