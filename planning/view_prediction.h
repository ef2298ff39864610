// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "core/mesh_query.h"
#include "core/range_grid.h"
#include "core/rig.h"
#include "core/rigid_transform.h"

namespace dubsar {

/// What a scanner at a pose will see well, before it is asked.
struct ScannerModel {
  ScannerView view;  ///< laser and camera at the middle row
  double spacing_mm = 0.1;
  double noise_mm = 0.02;  ///< of a sample along the ray at normal incidence
  /// The measuring volume in the scanner frame; without bounds where unknown.
  Eigen::AlignedBox3d field_mm{Eigen::Vector3d::Constant(-1e30), Eigen::Vector3d::Constant(1e30)};

  [[nodiscard]] static ScannerModel of(const Rig& rig, double noise_mm);
  [[nodiscard]] static ScannerModel of(const RangeGrid& grid, double noise_mm);
  /// As of(grid, noise_mm), within what that scan certainly looked over: the rig's field, as far as its rows
  /// went; where no rig is known, what the grid's own returns span, nothing where there are none; either less
  /// the outermost three spacings (nine in depth; without a rig at the far end alone), where samples may lack
  /// neighbours for no other reason than that the field ends.
  [[nodiscard]] static ScannerModel that_took(const RangeGrid& grid, const Rig* rig, double noise_mm);
};

/// Chance that a sample whose surface is inclined by the angle of this cosine against the ray is not
/// potentially sparse: all four links shorter than 3µ, given the noise, which grows with incidence. 0
/// at 70.5° and beyond; at µ = 0.05 mm, 0.02 mm noise and 60° one link in nine is too long.
[[nodiscard]] double dense_sampling_chance(double cosine, double spacing_mm, double noise_mm);

/// Half space of the stage that hides what is below it, model frame: n·p < offset.
struct HiddenHalf {
  Eigen::Vector3d normal{0, 0, 1};
  double offset_mm = 0;
};

/// Everything at one pose that the test of a point needs, computed once.
class ViewPredictor {
 public:
  ViewPredictor(const ScannerModel& scanner, const RigidTransform& model_from_scanner,
                const MeshQuery& occluders, double clearance_mm,
                std::optional<HiddenHalf> hidden = std::nullopt);

  /// Chance by position in the field and incidence alone, no rays cast; 0 when it faces away or is outside.
  [[nodiscard]] double facing_chance(const Eigen::Vector3d& p_mm, const Eigen::Vector3d& normal) const;
  /// True when neither laser nor camera is shaded by the model or by the support.
  [[nodiscard]] bool unobstructed(const Eigen::Vector3d& p_mm, const Eigen::Vector3d& normal) const;
  /// Both together: the chance that a scan from here samples the point densely.
  [[nodiscard]] double chance(const Eigen::Vector3d& p_mm, const Eigen::Vector3d& normal) const {
    const double facing = facing_chance(p_mm, normal);
    return facing > 0.02 && unobstructed(p_mm, normal) ? facing : 0.0;
  }
  /// How far behind the point this view samples the model well, along the laser's ray through the point: then
  /// nothing solid can be at the point. 0 when it does not.
  [[nodiscard]] double looks_past_mm(const Eigen::Vector3d& p_mm) const;
  /// Unit vector from the model to the scanner.
  [[nodiscard]] const Eigen::Vector3d& towards_scanner() const { return towards_scanner_; }
  /// Unit vector from the point to the camera when the laser meets it; towards_scanner() where the camera is
  /// not known. Model frame.
  [[nodiscard]] Eigen::Vector3d towards_camera(const Eigen::Vector3d& p_mm) const;

 private:
  [[nodiscard]] Eigen::Vector3d source(const std::optional<Eigen::Vector3d>& at_mm,
                                       const Eigen::Vector3d& p_scanner_mm) const;

  ScannerModel scanner_;
  RigidTransform model_from_scanner_;
  RigidTransform scanner_from_model_;
  const MeshQuery* occluders_;
  double clearance_mm_;
  std::optional<HiddenHalf> hidden_;
  Eigen::Vector3d towards_scanner_;
  Eigen::Vector3d motion_{0, 0, 0};  ///< unit, or zero
};

}  // namespace dubsar
