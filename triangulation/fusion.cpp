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
  std::size_t sample = 0;     ///< a corner of the triangle
  float along_mm = 0;         ///< from p along the line
  bool well_sampled = false;  ///< none of the corners is sparse
  std::uint8_t rim = 0;       ///< of the corner that is nearest to it
  float weight = 0;           ///< interpolated; 0 where the line misses the other scan's triangles
  float reliability = 0;      ///< interpolated
};

/// The line through a sample on which it moves. To where it meets other scans, not to their nearest points:
/// of a rough sheet the nearest point is the one that errs the same way as p, and averaging with it takes
/// away next to nothing of the noise.
struct Line {
  Vector3f p, n, u, v;

  Line(const Vector3f& at, const Vector3f& direction)
      : p(at), n(direction), u(direction.unitOrthogonal()), v(direction.cross(u)) {}
};

/// Where a line meets the triangles of a scan.
class LineProjector {
 public:
  LineProjector(const StitchSurface& s, const Line& line)
      : s_(&s), line_(&line), turn_(s.mirrored ? -1.0F : 1.0F) {}  // triangles run as their grid does

  /// Steps from a cell towards the line, then looks there and all around.
  [[nodiscard]] Projection from_cell(float at_row, float at_col) {
    const int last_row = s_->lattice.rows - 2;
    const int last_col = s_->lattice.cols - 2;
    int row = static_cast<int>(std::clamp(at_row, 0.0F, static_cast<float>(last_row)));
    int col = static_cast<int>(std::clamp(at_col, 0.0F, static_cast<float>(last_col)));
    for (int step = 0; step < kMostSteps; ++step) {
      const auto [rows, cols] = towards_line(row, col);
      const int next_row = std::clamp(row + rows, 0, last_row);
      const int next_col = std::clamp(col + cols, 0, last_col);
      if (next_row == row && next_col == col) {
        break;
      }
      row = next_row;
      col = next_col;
    }
    meet_cell(row, col);
    for (int r = std::max(row - 1, 0); r <= std::min(row + 1, last_row) && !(best_.weight > 0); ++r) {
      for (int c = std::max(col - 1, 0); c <= std::min(col + 1, last_col); ++c) {
        if (r != row || c != col) {
          meet_cell(r, c);
        }
      }
    }
    return best_;
  }

 private:
  struct Corner {
    float u, v;
  };
  static float wedge(const Corner& a, const Corner& b) { return a.u * b.v - a.v * b.u; }

  [[nodiscard]] std::size_t first_sample(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(s_->lattice.cols) +
           static_cast<std::size_t>(col);
  }

  [[nodiscard]] Corner seen_along(std::size_t i) const {
    const Vector3f d = s_->points[i] - line_->p;
    return {line_->u.dot(d), turn_ * line_->v.dot(d)};
  }

  /// To which of the cells beside this one the line passes, as rows and columns: none where it passes through
  /// this one, or a corner is missing.
  [[nodiscard]] std::pair<int, int> towards_line(int row, int col) const {
    const std::size_t i00 = first_sample(row, col);
    const std::size_t i10 = i00 + static_cast<std::size_t>(s_->lattice.cols);
    if ((s_->usable[i00] & s_->usable[i00 + 1] & s_->usable[i10] & s_->usable[i10 + 1] & kUsable) == 0) {
      return {0, 0};
    }
    const Corner c00 = seen_along(i00), c01 = seen_along(i00 + 1);
    const Corner c10 = seen_along(i10), c11 = seen_along(i10 + 1);
    const int left = wedge(c00, c10) < 0 ? 1 : 0;
    const int right = wedge(c11, c01) < 0 ? 1 : 0;
    const int above = wedge(c01, c00) < 0 ? 1 : 0;
    const int below = wedge(c10, c11) < 0 ? 1 : 0;
    return {below - above, right - left};
  }

  void meet_cell(int row, int col) {
    const std::size_t i00 = first_sample(row, col);
    const std::uint8_t cell = s_->cells[i00];
    if (cell == 0) {
      return;
    }
    const std::size_t i10 = i00 + static_cast<std::size_t>(s_->lattice.cols);
    const std::array<std::size_t, 4> i = {i00, i00 + 1, i10, i10 + 1};
    const std::array<Corner, 4> corners = {seen_along(i[0]), seen_along(i[1]), seen_along(i[2]),
                                           seen_along(i[3])};
    using Three = std::array<std::size_t, 3>;
    const bool anti = (cell & kCellAntidiagonal) != 0;
    if ((cell & kCellFirst) != 0) {
      meet(i, corners, anti ? Three{0, 2, 1} : Three{0, 2, 3});
    }
    if ((cell & kCellSecond) != 0) {
      meet(i, corners, anti ? Three{2, 3, 1} : Three{0, 3, 1});
    }
  }

  void meet(const std::array<std::size_t, 4>& samples, const std::array<Corner, 4>& corners,
            const std::array<std::size_t, 3>& which) {
    const Corner &a = corners[which[0]], &b = corners[which[1]], &c = corners[which[2]];
    const float wa = wedge(b, c);
    const float wb = wedge(c, a);
    const float wc = wedge(a, b);
    const float sum = wa + wb + wc;
    // Seen from below, or from the side: another fold, or no way to tell where.
    if (!(sum > 0)) {
      return;
    }
    const float slack = kSlack * sum;
    if (wa < slack || wb < slack || wc < slack) {
      return;
    }
    const std::array<std::size_t, 3> t = {samples[which[0]], samples[which[1]], samples[which[2]]};
    const float inverse = 1.0F / sum;
    const Vector3f &n = line_->n, &p = line_->p;
    const float along = (wa * n.dot(s_->points[t[0]] - p) + wb * n.dot(s_->points[t[1]] - p) +
                         wc * n.dot(s_->points[t[2]] - p)) *
                        inverse;
    if (best_.weight > 0 && std::abs(along) >= std::abs(best_.along_mm)) {
      return;
    }
    best_.sample = t[0];
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
  static constexpr int kMostSteps = 6;
  const StitchSurface* s_;
  const Line* line_;
  float turn_;
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

/// Along which a sample moves: towards the laser. It is known to lie on the laser's ray, and errs along it,
/// so samples keep the order that they have in the grid, and no cell is folded over however noisy they are;
/// the normal of one sample is noisy, too. On a surface that the laser only grazes, along the normal all the
/// same: there a ray hardly comes nearer to where the others have the surface. So, too, where the laser's
/// place is not known.
Vector3f averaging_direction(const StitchSurface& from, int row, const Vector3f& p, const Vector3f& normal) {
  constexpr float kLeastCos = 0.3F;
  if (!from.view.laser_mm) {
    return normal;
  }
  const Vector3f ray = from.view.to_laser(p.cast<double>(), row).cast<float>();
  return ray.dot(normal) > kLeastCos ? ray : normal;
}

}  // namespace

FusedSamples::FusedSamples(const StitchSurface& of) : slot(of.points.size(), kNone) {}

void FusedSamples::forget_if(const std::function<bool(std::uint32_t)>& gone) {
  // Mostly all stay.
  const std::size_t first = parallel_reduce_ordered(
      samples.size(), 16384, samples.size(),
      [&](std::size_t begin, std::size_t end) {
        while (begin < end && !gone(samples[begin])) {
          ++begin;
        }
        return begin < end ? begin : samples.size();
      },
      [](std::size_t& total, std::size_t part) { total = std::min(total, part); });
  std::size_t out = first;
  for (std::size_t at = first; at < samples.size(); ++at) {
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
      const Vector3f along = averaging_direction(from, from.lattice.sample_row(i), p, normal);
      const Line line(p, along);
      const float tilt = along.dot(normal);  // × a distance along the line: the distance along the normal
      float feather = 0;
      found.clear();
      for (const auto& [k, start] : starts) {
        const StitchSurface& other = *others[k];
        const auto [row, col] = start.place_of(p);
        Projection q = LineProjector(other, line).from_cell(row, col);
        if (q.weight > 0 && !(tilt * std::abs(q.along_mm) <= pairs[k]->reach_mm &&
                              normal.dot(other.normal(q.sample)) > pairs[k]->min_normal_cos)) {
          // Another fold of the surface: from the nearest sample that looks the same way there is a way to
          // the right one.
          const std::int64_t j = pair_of(from, i, start, other, *pairs[k]);
          q = j < 0
                  ? Projection()
                  : LineProjector(other, line)
                        .from_cell(static_cast<float>(other.lattice.sample_row(static_cast<std::size_t>(j))),
                                   static_cast<float>(other.lattice.sample_col(static_cast<std::size_t>(j))));
        }
        if (q.weight > 0 && tilt * std::abs(q.along_mm) <= pairs[k]->reach_mm) {
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
        shift2_sum += weight * square(tilt * q.along_mm);
        pose_sum += square(weight * pose_sigma_mm(*others[k]));
        weight_sum += weight;
        doubt *= 1.0F - q.reliability;
        sparse = sparse && !q.well_sampled;
        ++scans;
      }
      const float shift_mm = shift_sum / weight_sum;
      out.points[at] = p + shift_mm * along;
      // Weights are inverse variances: the disagreement is their chi-square.
      const float chi2 = std::max(0.0F, shift2_sum - weight_sum * square(tilt * shift_mm));
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
