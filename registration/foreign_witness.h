// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/range_grid.h"
#include "core/rigid_transform.h"
#include "core/sample_flags.h"
#include "core/scan_pose.h"
#include "registration/depth_raster.h"
#include "registration/foreign_matter.h"

namespace dubsar {

/// What all other scans say of one sample.
struct ForeignEvidence {
  std::uint16_t through = 0;  ///< scans that looked through it, at something well behind it
  std::uint16_t shown = 0;    ///< scans that show the same
  std::uint16_t free = 0;     ///< scans that saw something behind it, or nothing where it must show
  bool front = false;         ///< some scan saw something behind it, just there
};

/// Takes points of one scan's frame to another's.
struct IntoOther {
  IntoOther(const ScanPose& from, const ScanPose& to);
  Eigen::Vector3f operator()(const Eigen::Vector3f& p_mm) const { return rotation * p_mm + shift_mm; }

  Eigen::Matrix3f rotation;
  Eigen::Vector3f shift_mm;
};

/// What is kept of a scan to hold it against others: itself where it is small, else every second sample or
/// fewer, for it is about millimetres.
struct ForeignMatter::Witness {
  Witness(const RangeGrid& from, const SampleFlags& flags);

  /// Of a sample, towards the camera; zero where it has no neighbours.
  [[nodiscard]] Eigen::Vector3f normal(std::size_t i) const;
  [[nodiscard]] std::size_t count(Matter what) const;
  /// Samples that stand in the air by chance are fewer.
  [[nodiscard]] double least_in_the_air() const;
  /// Whether the other scan looked through enough of some thousand samples of this one.
  [[nodiscard]] bool is_looked_through(const Witness& other, const IntoOther& into) const;
  /// How far apart its surface and the other's lie, where they are the same: noise, and what the poses are
  /// off by.
  [[nodiscard]] double apart_mm(const Witness& other, const IntoOther& into) const;
  /// Adds what the other scan says of each sample; how many of them it looked through. sigma_mm: of both
  /// poses.
  std::size_t ask(const Witness& other, const IntoOther& into, double sigma_mm,
                  std::vector<ForeignEvidence>& evidence) const;

  int stride = 1;
  RangeGrid grid;                  ///< every stride-th sample
  std::vector<std::uint8_t> good;  ///< [samples], 1 on those that are surely sampled
  std::vector<Matter> matter;      ///< [samples], as far as it was found out; empty: nothing foreign
  std::vector<int> looked_through_by;
  bool pins = false;
  Eigen::Vector3f up{0, 0, 1};
  DepthRaster raster;
};

}  // namespace dubsar
