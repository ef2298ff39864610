// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/fusion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "triangulation/line_projection.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

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
        Projection q = project(line, other, row, col);
        if (q.weight > 0 && !(tilt * std::abs(q.along_mm) <= pairs[k]->reach_mm &&
                              normal.dot(other.normal(q.sample)) > pairs[k]->min_normal_cos)) {
          // Another fold of the surface: from the nearest sample that looks the same way there is a way to
          // the right one.
          const std::int64_t j = pair_of(from, i, start, other, *pairs[k]);
          q = j < 0 ? Projection()
                    : project(line, other,
                              static_cast<float>(other.lattice.sample_row(static_cast<std::size_t>(j))),
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
