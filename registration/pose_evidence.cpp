// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pose_evidence.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dubsar {

namespace {

constexpr float kCompatible = 0.7F;   ///< cosine between normals of one surface
constexpr float kFacing = 0.5F;       ///< cosine to the camera from which a scanner surely gets a return
constexpr int kSeenThroughReach = 1;  ///< cells around a place that must all be seen through
constexpr int kMissingReach = 2;      ///< cells around a place that must all be empty
/// Samples whose memory is asked for before the first of it is read.
constexpr std::size_t kAtOnce = 32;

struct Placed {
  std::size_t sample = 0;
  Eigen::Vector3f p;                        ///< where the target has it …
  const DepthRaster::Cell* cell = nullptr;  ///< … and what it saw there
};

/// Has what is asked of the sample in a cell brought near.
void fetch_straight(const SurfaceLevel& level, const DepthRaster::Cell* cell) {
  if (cell != nullptr && cell->sample >= 0) {
    const auto j = static_cast<std::size_t>(cell->sample);
    __builtin_prefetch(&level.usable[j]);
    __builtin_prefetch(&level.normals[j]);
  }
}

}  // namespace

PoseEvidence pose_evidence(const SurfaceLevel& source, const SurfaceLevel& target,
                           const RigidTransform& target_from_source, const EvidenceOptions& options,
                           std::vector<std::uint8_t>* close_marks) {
  PoseEvidence out;
  if (close_marks != nullptr) {
    close_marks->assign(source.samples.size(), 0);
  }
  const Eigen::Matrix3f rotation = target_from_source.rotation.cast<float>();
  const Eigen::Vector3f shift = target_from_source.translation_mm.cast<float>();
  const Eigen::Vector3f up = (-target.grid.view.direction).cast<float>();
  const auto tolerance = static_cast<float>(options.tolerance_mm);
  const auto band = static_cast<float>(options.band_mm);
  const std::size_t count = source.samples.size();
  const std::size_t used = std::min(count, static_cast<std::size_t>(options.most_samples));
  std::array<Placed, kAtOnce> placed;
  for (std::size_t k = 0; k < used; ++k) {
    if (k % kAtOnce == 0) {
      const std::size_t more = std::min(kAtOnce, used - k);
      for (std::size_t m = 0; m < more; ++m) {
        placed[m].sample = (2 * (k + m) + 1) * count / (2 * used);
        placed[m].p = rotation * source.samples[placed[m].sample].position_mm + shift;
        placed[m].cell = target.raster.at(placed[m].p);
        __builtin_prefetch(placed[m].cell);
      }
      for (std::size_t m = 0; m < more; ++m) {
        fetch_straight(target, placed[m].cell);
      }
    }
    const auto& [i, p, cell] = placed[k % kAtOnce];
    const Eigen::Vector3f n = rotation * source.samples[i].normal;
    ++out.sent;
    if (cell == nullptr || cell->sample < 0) {
      out.missing +=
          n.dot(up) > kFacing && target.raster.in_field(p) && target.raster.empty_around(p, kMissingReach)
              ? 1
              : 0;
      continue;
    }
    const auto j = static_cast<std::size_t>(cell->sample);
    const float above = target.raster.height(p) - target.raster.height(*cell);
    if (above > band) {
      out.in_front += target.raster.seen_through(p, band, kSeenThroughReach) ? 1 : 0;
      continue;
    }
    if (above < -band || target.usable[j] == 0) {
      continue;
    }
    const Eigen::Vector3f& n_target = target.normals[j];
    const float residual = n_target.dot(p - cell->point_mm);
    if (std::abs(residual) <= tolerance && n.dot(n_target) > kCompatible) {
      ++out.close;
      if (close_marks != nullptr) {
        (*close_marks)[i] = 1;
      }
      out.sum_r2_mm2 += static_cast<double>(residual * residual);
    } else {
      ++out.apart;
    }
  }
  return out;
}

}  // namespace dubsar
