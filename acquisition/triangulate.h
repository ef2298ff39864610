// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "acquisition/stripe.h"
#include "core/range_grid.h"
#include "core/result.h"
#include "core/rig_calibration.h"

namespace dubsar {

/// One profile in the scanner frame at stage position 0.
struct TriangulatedProfile {
  std::vector<float> x, y, z;  ///< mm
  std::vector<std::uint8_t> valid;
};

/// Turns stripes into points through a calibration: image point → ray → laser plane → where the stage was.
/// The rays of the camera are tabulated when it is made; use() of it is then a handful of operations a
/// sample, from any number of threads at once.
class Triangulator {
 public:
  Triangulator(const RigCalibration& calibration, StripeAxis axis);

  [[nodiscard]] const RigCalibration& calibration() const { return calibration_; }
  [[nodiscard]] StripeAxis axis() const { return axis_; }
  [[nodiscard]] int samples_per_profile() const { return samples_; }
  /// The point that the camera sees at `along_px` of sample i with the laser plane `plane`; camera frame.
  [[nodiscard]] std::optional<Eigen::Vector3d> point_mm(int sample, double along_px,
                                                        const Plane& plane) const;
  /// `position` of the stage when the frame was taken: mm or radians, as RigMotion has it. Samples outside
  /// of the measuring volume come out invalid: they are reflections or the support.
  void triangulate(const StripeProfile& stripe, double position, TriangulatedProfile& out) const;

 private:
  [[nodiscard]] Eigen::Vector2d ray(int sample, double along_px) const;

  RigCalibration calibration_;
  StripeAxis axis_;
  int samples_ = 0;
  int nodes_ = 0;                      ///< per sample
  std::vector<Eigen::Vector2d> rays_;  ///< [samples × nodes] normalised coordinates every kNodePx along
  RigidTransform scanner_from_camera_;
};

/// Frames of one scan, stripe by stripe, into a grid: rows in the order given.
class FrameGrid {
 public:
  /// `step` between rows, for the grid's view; mm or radians.
  FrameGrid(const Triangulator& triangulator, double step);
  void append(const StripeProfile& stripe, double position);
  /// The grid so far, with its spacing.
  [[nodiscard]] RangeGrid take();

 private:
  const Triangulator& triangulator_;
  RangeGrid grid_;
  TriangulatedProfile profile_;
};

}  // namespace dubsar
