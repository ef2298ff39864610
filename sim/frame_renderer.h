// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/gray_image.h"
#include "core/rig_calibration.h"
#include "sim/frame_optics.h"
#include "sim/frame_target.h"

namespace dubsar::sim {

/// What a simulated camera and laser are like. Signals are shares of the full range of the image.
struct FrameOptions {
  double pixel_um = 5.5;
  double wavelength_um = 0.65;
  double f_number = 5.6;
  double defocus_waves = 0;      ///< wave front error at the aperture's rim
  double laser_sigma_mm = 0.02;  ///< standard deviation across the laser sheet
  double laser_signal = 0.5;     ///< in the middle of the stripe on clay of albedo 0.5, facing the laser
  double ambient_signal = 0.03;  ///< of clay of albedo 0.5, facing the camera
  /// Standard deviation over mean of the light on a point of the sensor: 1 for a laser on bright metal, about
  /// 0.7 on clay, which scrambles the polarisation, less for a laser of many wavelengths.
  double speckle_contrast = 0;
  double gloss = 0;  ///< share of the laser's light that goes on as from a mirror
  double full_well_electrons = 10000;
  double read_noise_electrons = 15;
  double black_level = 1;  ///< grey values
  std::uint64_t seed = 1;
};

/// Renders what the camera of a rig sees. The laser sheet is cast from its source onto the target, every
/// quarter of a pixel around it is traced back from the camera (shadows of laser and camera, depth edges and
/// surface texture are those of the target). Speckle is what coherent light does: each lit spot gets a random
/// phase, the field is convolved with the aperture's coherent point spread and squared; it therefore has the
/// grain, the statistics and the effect on the stripe's position of real speckle at that aperture. Then
/// ambient light, shot noise, read noise, quantisation to 8 bits, and saturation. A Scheimpflug mount is
/// assumed: the laser plane is in focus throughout.
class FrameRenderer {
 public:
  /// `truth` needs laser_source_mm, a point of the laser plane at position 0 (of the mirror's axis for a
  /// galvanometer).
  FrameRenderer(const RigCalibration& truth, const FrameOptions& options);

  /// The frame at a stage position (which only turns the laser of a galvanometer; the target is where the
  /// stage has brought it). `frame` tells the noise of two frames apart. The same bytes for any number of
  /// threads.
  [[nodiscard]] GrayImage render(const FrameTarget& target, bool laser_on, double position,
                                 std::uint64_t frame) const;
  /// Where the middle of the laser's light falls in each column when seen without any blur, px; NaN where no
  /// lit surface is seen, or more than one.
  [[nodiscard]] std::vector<double> true_rows(const FrameTarget& target, double position) const;

 private:
  struct Band;
  [[nodiscard]] Band lit_band(const FrameTarget& target, const Plane& plane) const;
  void light(const FrameTarget& target, const Plane& plane, Band& band) const;
  void image(const Band& band, std::uint64_t frame, std::vector<float>& signal) const;
  [[nodiscard]] std::vector<float> ambient(const FrameTarget& target) const;
  [[nodiscard]] Eigen::Vector3d ray_through(double u, double v) const;

  RigCalibration truth_;
  FrameOptions options_;
  PointSpread spread_;
};

}  // namespace dubsar::sim
