// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/pose_step.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/order_statistics.h"
#include "core/parallel.h"
#include "triangulation/line_projection.h"

namespace dubsar {

namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// A distance between the two surfaces, and the row of motion_row().
struct Distance {
  Motion row;
  double mm;
};
using Distances = std::vector<Distance>;

/// Seen by its own scanner at no more than 66° from the normal, which is that of the sample.
bool is_seen_steeply(const StitchSurface& s, std::size_t i, const Vector3f& normal) {
  constexpr float kLeastCos = 0.4F;
  const Vector3f to_camera = s.view.camera_mm
                                 ? Vector3f((s.view.camera_mm->cast<float>() - s.points[i]).normalized())
                                 : Vector3f(-s.view.direction.cast<float>());
  return normal.dot(to_camera) > kLeastCos;
}

/// From samples of `from` along their normals to the triangles of `to`.
class Measuring {
 public:
  /// `sign` turns the distances of the way back.
  Measuring(const StitchSurface& from, const StitchSurface& to, const Pairs& pairs, const Vector3d& about_mm,
            double sign)
      : from_(from), to_(to), pairs_(pairs), about_mm_(about_mm), sign_(sign) {}

  [[nodiscard]] Distances all() const {
    // Of a small overlap four samples a node, else one. Of a large one nodes evenly apart: with noise of half
    // a µ so many tell the step to a tenth of what is held to be one (misplacement.cpp).
    constexpr std::size_t kSmall = 500;
    constexpr std::size_t kEnough = 8000;
    const bool is_small = pairs_.nodes < kSmall;
    const std::size_t stride = std::max<std::size_t>(1, pairs_.nodes / kEnough);
    const auto is_passed_over = [&](std::size_t node) {
      const auto diagonal = [&] { return from_.lattice.row_of(node) + from_.lattice.col_of(node); };
      return stride > 1 && static_cast<std::size_t>(diagonal()) % stride != 0;
    };
    return parallel_reduce_ordered(
        pairs_.match.size(), 512, Distances{},
        [&](std::size_t begin, std::size_t end) {
          Distances found;
          for (std::size_t node = begin; node < end; ++node) {
            if (pairs_.match[node] < 0 || is_passed_over(node)) {
              continue;
            }
            const PairStart start = pair_start(from_, node, to_, pairs_);
            if (!is_small) {
              measure(static_cast<std::size_t>(from_.node_sample[node]), start, found);
              continue;
            }
            from_.lattice.for_each_sample(node, [&](std::size_t i) {
              if (from_.lattice.sample_row(i) % 2 == 0 && from_.lattice.sample_col(i) % 2 == 0) {
                measure(i, start, found);
              }
            });
          }
          return found;
        },
        [](Distances& total, const Distances& part) { total.insert(total.end(), part.begin(), part.end()); });
  }

 private:
  void measure(std::size_t i, const PairStart& start, Distances& found) const {
    constexpr int kLeastRim = 4;
    constexpr float kLeastNormalCos = 0.8F;
    if (from_.usable[i] == 0 || from_.is_sparse(i) || from_.rim[i] < kLeastRim) {
      return;
    }
    const Vector3f& p = from_.points[i];
    const Vector3f n = from_.normal(i);
    if (!is_seen_steeply(from_, i, n)) {
      return;
    }
    const Vector3f there = pairs_.on_other(p);
    const auto [row, col] = start.place_of(there);
    const Projection q = project(Line(there, n), to_, row, col);
    if (q.weight > 0 && q.well_sampled && q.rim >= kLeastRim && std::abs(q.along_mm) <= pairs_.reach_mm &&
        is_seen_steeply(to_, q.sample, q.normal) && n.dot(q.normal) > kLeastNormalCos) {
      const float apart_mm = q.along_mm + n.dot(there - p);
      found.push_back({motion_row(p.cast<double>(), sign_ * n.cast<double>(), about_mm_), apart_mm});
    }
  }

  const StitchSurface& from_;
  const StitchSurface& to_;
  const Pairs& pairs_;
  Vector3d about_mm_;
  double sign_;
};

/// Of a system that a narrow overlap may leave open in some directions: none of these.
Motion solved(const PoseStep& step) {
  MotionMatrix a = step.information;
  a.diagonal().array() += 1e-9 * a.diagonal().maxCoeff();
  return a.ldlt().solve(step.right);
}

/// Residuals of more than this × their standard deviation lose most of their weight.
constexpr double kOutlier = 3.0;

void sum_up(const Distances& all, const std::vector<double>& weights, PoseStep& out) {
  out.information.setZero();
  out.right.setZero();
  for (std::size_t k = 0; k < all.size(); ++k) {
    out.information.noalias() += weights[k] * all[k].row * all[k].row.transpose();
    out.right += weights[k] * all[k].mm * all[k].row;
  }
}

}  // namespace

Motion motion_row(const Vector3d& p_mm, const Vector3d& n, const Vector3d& about_mm) {
  Motion row;
  row << (p_mm - about_mm).cross(n), n;
  return row;
}

bool PoseStep::is_known() const {
  constexpr std::size_t kLeast = 50;
  return count >= kLeast && variance_mm2 > 0;
}

double PoseStep::step_mm() const {
  constexpr double kSignificance = 4.0;
  if (!is_known()) {
    return 0;
  }
  const Motion motion = solved(*this);
  const double n = static_cast<double>(count);
  const double step2 = motion.dot(information * motion) / n;
  // Six unknowns take up six parts in n of the noise.
  const double error2 = 6.0 * kDistancesPerIndependent * variance_mm2 / n;
  return step2 > kSignificance * kSignificance * error2 ? std::sqrt(step2 - error2) : 0.0;
}

PoseStep pose_step(const StitchSurface& a, const Pairs& there, const StitchSurface& b, const Pairs& back) {
  constexpr int kRounds = 6;
  PoseStep out;
  if (there.nodes == 0 && back.nodes == 0) {
    return out;
  }
  const Eigen::AlignedBox3f common = a.box.intersection(b.box);
  out.about_mm = (common.isEmpty() ? a.box.merged(b.box) : common).center().cast<double>();
  Distances all = Measuring(a, b, there, out.about_mm, 1.0).all();
  // What lies before b as seen along its normal is a, which the motion is to take onto it.
  const Distances other = Measuring(b, a, back, out.about_mm, -1.0).all();
  all.insert(all.end(), other.begin(), other.end());
  out.count = all.size();
  if (all.empty()) {
    return out;
  }
  std::vector<double> weights(all.size(), 1.0);
  std::vector<double> residuals(all.size());
  for (int round = 0; round < kRounds; ++round) {
    sum_up(all, weights, out);
    const Motion motion = solved(out);
    for (std::size_t k = 0; k < all.size(); ++k) {
      residuals[k] = std::abs(all[k].mm - all[k].row.dot(motion));
    }
    const double sigma_mm = std::max(kSigmaOfMedian * median_of(residuals), 1e-6);
    out.variance_mm2 = sigma_mm * sigma_mm;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const double r = residuals[k] / (kOutlier * sigma_mm);
      weights[k] = 1.0 / ((1.0 + r * r) * (1.0 + r * r));
    }
  }
  return out;
}

}  // namespace dubsar
