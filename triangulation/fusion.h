// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/job.h"
#include "triangulation/pairing.h"
#include "triangulation/stitch_surface.h"

namespace dubsar {

/// Where samples of one scan go when their pairs have had their say. Only of those that were asked about:
/// most samples of a scan are another one's to show.
struct FusedSamples {
  static constexpr std::uint32_t kNone = 0xffffffffU;

  std::vector<std::uint32_t> slot;      ///< [rows*cols], index into the arrays below, or kNone
  std::vector<std::uint32_t> samples;   ///< index of the sample in the grid
  std::vector<Eigen::Vector3f> points;  ///< model frame
  /// (1 - Π(1 - r) over the supporting scans, of the passes of one the best) / (1 + (sigma / µ)²); less where
  /// scans had to be taken elsewhere than their poses say
  std::vector<float> reliability;
  /// Standard deviation along the normal, mm: of noise and poses, as far as averaging leaves them, and of
  /// triangles that lie off bent clay; more where the scans disagree by more.
  std::vector<float> sigma_mm;
  std::vector<std::uint8_t> sparse;  ///< 1 for a sparse sample that projects onto no well-sampled triangle
  std::vector<std::uint8_t> scans;   ///< supporting scans, itself included

  FusedSamples() = default;
  explicit FusedSamples(const StitchSurface& of);
  /// Forgets the samples for which gone(sample).
  void forget_if(const std::function<bool(std::uint32_t)>& gone);
  /// Makes room for so many; what is new is to be written.
  void resize(std::size_t count);
  /// Forgets all but the first so many.
  void forget_from(std::size_t first);
  /// Of a sample that has been fused.
  [[nodiscard]] const Eigen::Vector3f& point(std::size_t sample) const { return points[slot[sample]]; }
};

/// Seed 001, section 4: the reliability-weighted average of a sample and its projections, along the laser's
/// ray, on the triangles of the scans it pairs with (along its normal where the laser grazes the surface, or
/// its place is not known). A projection is as good as the samples that it lies between (their variances,
/// interpolated). `others` and `pairs` run in parallel, in the order of scan ids. Where the other scan has no
/// triangle nothing is counted. Appends the samples `which`, usable ones not yet in `out`; it is quickest
/// when those of one node follow each other. Of a job that is cancelled it appends none.
void fuse(const StitchSurface& from, std::span<const StitchSurface* const> others,
          std::span<const Pairs* const> pairs, std::span<const std::uint32_t> which, FusedSamples& out,
          const JobContext& job = {});

}  // namespace dubsar
