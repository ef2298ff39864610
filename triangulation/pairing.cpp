// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/pairing.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/order_statistics.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

/// Whether a surface element could face the scanner, with some leave for noise and for camera and laser
/// standing apart.
bool may_see(const ScannerView& view, const Vector3f& p, const Vector3f& normal) {
  constexpr float kMostSine = -0.2F;
  const Vector3f to_camera = view.camera_mm ? Vector3f((view.camera_mm->cast<float>() - p).normalized())
                                            : Vector3f(-view.direction.cast<float>());
  return normal.dot(to_camera) > kMostSine;
}

/// The step from one column (or row) to the next around a sample, over as many as noise leaves little of:
/// `stride` apart in the arrays, the sample at `place` of `count`. Zero where it stands alone.
Vector3f mean_step(const StitchSurface& to, std::size_t at, int place, int count, std::size_t stride) {
  for (const int reach : {3, 1}) {
    const auto jump = static_cast<std::size_t>(reach) * stride;
    const bool after = place + reach < count && to.usable[at + jump] != 0;
    const bool before = place >= reach && to.usable[at - jump] != 0;
    if (after || before) {
      const Vector3f along = to.points[after ? at + jump : at] - to.points[before ? at - jump : at];
      return along / static_cast<float>((after ? reach : 0) + (before ? reach : 0));
    }
  }
  return Vector3f::Zero();
}

/// From where to walk: likely_sample(), if that is nearer to p than the start; else the start.
std::size_t jump(const StitchSurface& to, const PairStart& start, const Vector3f& p) {
  const std::int64_t there = likely_sample(start, to, p);
  return there >= 0 && (to.points[static_cast<std::size_t>(there)] - p).squaredNorm() <
                           (start.origin - p).squaredNorm()
             ? static_cast<std::size_t>(there)
             : static_cast<std::size_t>(start.sample);
}

/// From sample to sample of the grid towards p: the one at which no neighbour is nearer.
std::size_t walk(const StitchSurface& to, std::size_t at, const Vector3f& p, float& distance2) {
  constexpr int kMostSteps = 16;
  const auto width = static_cast<std::size_t>(to.lattice.cols);
  int row = to.lattice.sample_row(at);
  int col = to.lattice.sample_col(at);
  int from_row = row - 3;  // of the step before: what lies beside both is known to be farther
  int from_col = col - 3;
  distance2 = (to.points[at] - p).squaredNorm();
  for (int step = 0; step < kMostSteps; ++step) {
    int next_row = row;
    int next_col = col;
    const int last_row = std::min(row + 1, to.lattice.rows - 1);
    const int last_col = std::min(col + 1, to.lattice.cols - 1);
    for (int r = std::max(row - 1, 0); r <= last_row; ++r) {
      const bool row_is_known = std::abs(r - from_row) <= 1;
      for (int c = std::max(col - 1, 0); c <= last_col; ++c) {
        if (row_is_known && std::abs(c - from_col) <= 1) {
          continue;
        }
        const std::size_t i = static_cast<std::size_t>(r) * width + static_cast<std::size_t>(c);
        const float d2 = (to.points[i] - p).squaredNorm();
        if (d2 < distance2 && to.usable[i] != 0) {
          distance2 = d2;
          next_row = r;
          next_col = c;
        }
      }
    }
    if (next_row == row && next_col == col) {
      break;
    }
    from_row = row;
    from_col = col;
    row = next_row;
    col = next_col;
  }
  return static_cast<std::size_t>(row) * width + static_cast<std::size_t>(col);
}

/// Nearest usable sample within reach, model frame, or -1.
std::int64_t nearest_sample(const StitchSurface& to, const Vector3f& p, float reach_mm) {
  // What is looked up is every fourth sample; the walk goes to the nearest of all.
  const auto near_mm = static_cast<float>(2.0 * to.spacing_mm);
  const Vector3f there = (to.scanner_from_model * p.cast<double>()).cast<float>();
  // Most places that the other scan has not seen lie at another depth than all that it has thereabouts.
  if (!to.lookup->may_hold_samples(to.lookup->reach_of(there, reach_mm + near_mm))) {
    return -1;
  }
  const std::int64_t start = to.lookup->nearest(there, reach_mm + near_mm);
  if (start < 0) {
    return -1;
  }
  float distance2 = 0;
  const std::size_t at = walk(to, static_cast<std::size_t>(start), p, distance2);
  return distance2 <= reach_mm * reach_mm ? static_cast<std::int64_t>(at) : -1;
}

/// Fills in `match` and `nodes`.
void find_matches(const StitchSurface& from, const StitchSurface& to, Pairs& pairs, const JobContext& job) {
  pairs.nodes = 0;
  pairs.match.assign(from.lattice.size(), -1);
  Eigen::AlignedBox3f box = to.box;
  if (box.isEmpty()) {
    return;
  }
  box.min().array() -= pairs.reach_mm;
  box.max().array() += pairs.reach_mm;
  pairs.nodes = parallel_reduce_ordered(
      pairs.match.size(), 512, std::size_t{0},
      [&](std::size_t begin, std::size_t end) {
        std::size_t count = 0;
        for (std::size_t node = begin; node < end && !job.cancelled(); ++node) {
          const std::int32_t sample = from.node_sample[node];
          if (sample < 0) {
            continue;
          }
          const auto i = static_cast<std::size_t>(sample);
          const Vector3f p = pairs.on_other(from.points[i]);
          if (!box.contains(p)) {
            continue;
          }
          const Vector3f normal = from.normal(i);
          // A scan cannot have seen what faces away from it.
          if (!may_see(to.view, p, normal)) {
            continue;
          }
          const std::int64_t j = nearest_sample(to, p, pairs.reach_mm);
          if (j >= 0 && normal.dot(to.normal(static_cast<std::size_t>(j))) > pairs.min_normal_cos) {
            pairs.match[node] = static_cast<std::int32_t>(j);
            ++count;
          }
        }
        return count;
      },
      [](std::size_t& total, std::size_t part) { total += part; });
}

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
  using Distances = std::vector<float>;
  Distances distances = parallel_reduce_ordered(
      (n + step - 1) / step, 128, Distances{},
      [&](std::size_t begin, std::size_t end) {
        Distances found;
        for (std::size_t i = begin * step; i < std::min(end * step, n); i += step) {
          if (from.usable[i] == 0 || !box.contains(from.points[i]) ||
              !may_see(to.view, from.points[i], from.normal(i))) {
            continue;
          }
          const std::int64_t j = nearest_sample(to, from.points[i], static_cast<float>(reach_mm));
          if (j < 0) {
            continue;
          }
          const auto q = static_cast<std::size_t>(j);
          if (from.normal(i).dot(to.normal(q)) > 0.9F) {
            found.push_back(std::abs((from.points[i] - to.points[q]).dot(to.normal(q))));
          }
        }
        return found;
      },
      [](Distances& total, const Distances& part) { total.insert(total.end(), part.begin(), part.end()); });
  if (distances.size() < 8) {
    return -1;
  }
  return median_of(std::move(distances));
}

double pair_reach_mm(const StitchSurface& a, const StitchSurface& b, const PairingOptions& options) {
  const double spacing = std::max(a.spacing_mm, b.spacing_mm);
  const double sigma = std::hypot(a.told_pose_sigma_mm, b.told_pose_sigma_mm);
  const double plain =
      options.reach_factor * spacing + (std::isfinite(sigma) ? options.sigma_factor * sigma : 0.0);
  const double most = std::max(plain, options.most_reach_factor * spacing);
  const double measured = std::max(mismatch_mm(a, b, most), mismatch_mm(b, a, most));
  // The median of a half-normal is 0.67 sigma: four medians reach 2.7 sigma; tangential offsets come on top.
  return std::clamp(4.0 * measured + spacing, plain, most);
}

double step_mm(const StitchSurface& a, const StitchSurface& b, double reach_mm) {
  const double sigma_mm = kSigmaOfMedian * std::max(mismatch_mm(a, b, reach_mm), mismatch_mm(b, a, reach_mm));
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
                 const PairingOptions& options, const JobContext& job) {
  Pairs pairs;
  pairs.other_id = to.id;
  pairs.reach_mm = static_cast<float>(reach_mm);
  pairs.min_normal_cos = static_cast<float>(options.min_normal_cos);
  find_matches(from, to, pairs, job);
  return pairs;
}

Pairs find_pairs_anew(const StitchSurface& from, const StitchSurface& to, Pairs pairs,
                      const SmallMotion& onto) {
  pairs.onto = onto;
  find_matches(from, to, pairs, {});
  return pairs;
}

PairStart pair_start(const StitchSurface& from, std::size_t node, const StitchSurface& to,
                     const Pairs& pairs) {
  PairStart start;
  start.sample = pairs.match[node];
  const auto is_start = [&](std::size_t beside) {
    start.sample = pairs.match[beside];
    return start.sample >= 0;
  };
  if (start.sample < 0 && !from.lattice.any_within(node, 1, is_start)) {
    start.sample = -1;
    return start;
  }
  const auto at = static_cast<std::size_t>(start.sample);
  const int row = to.lattice.sample_row(at);
  const int col = to.lattice.sample_col(at);
  start.origin = to.points[at];
  start.row = static_cast<float>(row);
  start.col = static_cast<float>(col);
  const Vector3f u = mean_step(to, at, col, to.lattice.cols, 1);
  const Vector3f v = mean_step(to, at, row, to.lattice.rows, static_cast<std::size_t>(to.lattice.cols));
  const float uu = u.squaredNorm(), uv = u.dot(v), vv = v.squaredNorm();
  const float det = uu * vv - uv * uv;
  if (det > 0.05F * uu * vv) {
    start.cols_per_mm = (u * vv - v * uv) / det;
    start.rows_per_mm = (v * uu - u * uv) / det;
  }
  return start;
}

bool may_pair(const StitchSurface& from, std::size_t sample, const StitchSurface& to, std::size_t other,
              const Pairs& pairs) {
  return (pairs.on_other(from.points[sample]) - to.points[other]).squaredNorm() <=
             pairs.reach_mm * pairs.reach_mm &&
         from.normal(sample).dot(to.normal(other)) > pairs.min_normal_cos;
}

std::int64_t likely_sample(const PairStart& start, const StitchSurface& to, const Vector3f& p) {
  const auto [row, col] = start.place_of(p);
  const auto r = static_cast<int>(std::clamp(row + 0.5F, 0.0F, static_cast<float>(to.lattice.rows - 1)));
  const auto c = static_cast<int>(std::clamp(col + 0.5F, 0.0F, static_cast<float>(to.lattice.cols - 1)));
  const std::size_t there =
      static_cast<std::size_t>(r) * static_cast<std::size_t>(to.lattice.cols) + static_cast<std::size_t>(c);
  return to.usable[there] != 0 ? static_cast<std::int64_t>(there) : -1;
}

std::int64_t pair_of(const StitchSurface& from, std::size_t sample, const PairStart& start,
                     const StitchSurface& to, const Pairs& pairs) {
  const Vector3f p = pairs.on_other(from.points[sample]);
  float distance2 = 0;
  const std::size_t at = walk(to, jump(to, start, p), p, distance2);
  return may_pair(from, sample, to, at, pairs) ? static_cast<std::int64_t>(at) : -1;
}

}  // namespace dubsar
