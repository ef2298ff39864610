// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/view_prediction.h"

#include <algorithm>
#include <cmath>

#include "core/units.h"
#include "planning/clearing.h"
#include "planning/sparse_flags.h"

namespace dubsar {

namespace {

/// Where the scanner's positions are not known, it stands this far off.
constexpr double kFarMm = 1.0e4;
/// Slope beyond which a camera gets too little light back from a laser line.
const double kFlattestCosine = std::cos(rad_from_deg(70.0));

/// A scan that has returns in its first or last row was cut off there, or its field ends: it looked no
/// farther along its motion.
void end_at_rows(const RangeGrid& grid, Eigen::AlignedBox3d& field) {
  const Eigen::Vector3d& motion = grid.view.motion_per_row_mm;
  Eigen::Index axis = 0;
  if (grid.rows < 1 || !(motion.cwiseAbs().maxCoeff(&axis) > 0)) {
    return;
  }
  for (const int row : {0, grid.rows - 1}) {
    const bool is_upper = (row > 0) == (motion[axis] > 0);
    double& end_mm = is_upper ? field.max()[axis] : field.min()[axis];
    for (int col = 0; col < grid.cols; ++col) {
      if (grid.is_valid(row, col)) {
        const auto at_mm = static_cast<double>(grid.point(grid.index(row, col))[axis]);
        end_mm = is_upper ? std::min(end_mm, at_mm) : std::max(end_mm, at_mm);
      }
    }
  }
}

double upper_tail(double z) {
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

}  // namespace

ScannerModel ScannerModel::of(const Rig& rig, double noise_mm) {
  const Eigen::Vector3d half = 0.5 * Eigen::Vector3d(rig.field_x_mm, rig.field_y_mm, rig.depth_range_mm);
  return {rig.view, rig.spacing_mm, noise_mm, {-half, half}};
}

ScannerModel ScannerModel::of(const RangeGrid& grid, double noise_mm) {
  ScannerModel model;
  model.view = grid.view;
  model.spacing_mm = spacing_of(grid);
  model.noise_mm = noise_mm;
  return model;
}

ScannerModel ScannerModel::that_took(const RangeGrid& grid, const Rig* rig, double noise_mm) {
  ScannerModel model = of(grid, noise_mm);
  Eigen::AlignedBox3d field;
  if (rig != nullptr) {
    field = of(*rig, noise_mm).field_mm;
    end_at_rows(grid, field);
  } else {
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (grid.valid[i] != 0) {
        field.extend(grid.point(i).cast<double>());
      }
    }
  }
  // A slope that leaves the field in depth falls by up to three spacings a sample.
  const double border_mm = kGapInSpacings * model.spacing_mm;
  Eigen::Vector3d low(border_mm, border_mm, kGapInSpacings * border_mm);
  Eigen::Vector3d high = low;
  if (rig == nullptr) {
    // The nearest return is the face of a tablet, not the end of a field that nobody knows: all the writing
    // of a face that a scan looked straight at lies that near.
    (grid.view.direction.z() < 0 ? high : low).z() = 0;
  }
  model.field_mm = {field.min() + low, field.max() - high};
  return model;
}

double dense_sampling_chance(double cosine, double spacing_mm, double noise_mm) {
  if (!(cosine > 1.0 / kGapInSpacings)) {
    return 0.0;
  }
  const double tangent = std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) / cosine;
  // Across one µ the depth differs by µ tan; the link is too long when noise takes it beyond sqrt(8) µ.
  const double room_mm = spacing_mm * (std::sqrt(kGapInSpacings * kGapInSpacings - 1.0) - tangent);
  const double sigma_mm = std::sqrt(2.0) * noise_mm * (1.0 + 0.6 * (1.0 / cosine - 1.0));
  const double too_long = sigma_mm > 0 ? upper_tail(room_mm / sigma_mm) : 0.0;
  // Two links run down the slope; the other two are short.
  return (1.0 - too_long) * (1.0 - too_long);
}

ViewPredictor::ViewPredictor(const ScannerModel& scanner, const RigidTransform& model_from_scanner,
                             const MeshQuery& occluders, double clearance_mm,
                             std::optional<HiddenHalf> hidden)
    : scanner_(scanner),
      model_from_scanner_(model_from_scanner),
      scanner_from_model_(model_from_scanner.inverse()),
      occluders_(&occluders),
      clearance_mm_(clearance_mm),
      hidden_(hidden),
      towards_scanner_(model_from_scanner.rotation * -scanner.view.direction) {
  if (scanner_.view.motion_per_row_mm.norm() > 0) {
    motion_ = scanner_.view.motion_per_row_mm.normalized();
  }
}

Eigen::Vector3d ViewPredictor::source(const std::optional<Eigen::Vector3d>& at_mm,
                                      const Eigen::Vector3d& p_scanner_mm) const {
  if (!at_mm) {
    return p_scanner_mm - kFarMm * scanner_.view.direction;
  }
  // The scanner moves along until its laser meets the point.
  const Eigen::Vector3d& laser_mm = scanner_.view.laser_mm ? *scanner_.view.laser_mm : *at_mm;
  return *at_mm + motion_ * motion_.dot(p_scanner_mm - laser_mm);
}

Eigen::Vector3d ViewPredictor::towards_camera(const Eigen::Vector3d& p_mm) const {
  if (!scanner_.view.camera_mm) {
    return towards_scanner_;
  }
  const Eigen::Vector3d p = scanner_from_model_ * p_mm;
  return model_from_scanner_.rotation * (source(scanner_.view.camera_mm, p) - p).normalized();
}

double ViewPredictor::facing_chance(const Eigen::Vector3d& p_mm, const Eigen::Vector3d& normal) const {
  if (hidden_ && hidden_->normal.dot(p_mm) < hidden_->offset_mm) {
    return 0.0;
  }
  const Eigen::Vector3d p = scanner_from_model_ * p_mm;
  if (!scanner_.field_mm.contains(p)) {
    return 0.0;
  }
  const Eigen::Vector3d n = scanner_from_model_.rotation * normal;
  const double laser = n.dot((source(scanner_.view.laser_mm, p) - p).normalized());
  if (laser <= kFlattestCosine) {
    return 0.0;
  }
  const double camera = n.dot((source(scanner_.view.camera_mm, p) - p).normalized());
  if (camera <= kFlattestCosine) {
    return 0.0;
  }
  // Spacing follows the laser's incidence, noise the flatter of the two.
  const double light = std::clamp((camera - kFlattestCosine) / 0.1, 0.0, 1.0);
  return light * dense_sampling_chance(laser, scanner_.spacing_mm, scanner_.noise_mm);
}

double ViewPredictor::looks_past_mm(const Eigen::Vector3d& p_mm) const {
  constexpr double kCertain = 0.5;
  const Eigen::Vector3d laser =
      model_from_scanner_ * source(scanner_.view.laser_mm, scanner_from_model_ * p_mm);
  const Eigen::Vector3d ray = (p_mm - laser).normalized();
  const auto hit = occluders_->first_hit(p_mm.cast<float>(), ray.cast<float>(),
                                         static_cast<float>(clearance_mm_), static_cast<float>(kFarMm));
  if (!hit) {
    return 0.0;
  }
  const Eigen::Vector3d behind = p_mm + hit->distance_mm * ray;
  const Eigen::Vector3d normal = hit->normal.cast<double>();
  return facing_chance(behind, normal) > kCertain && unobstructed(behind, normal) ? hit->distance_mm : 0.0;
}

bool ViewPredictor::unobstructed(const Eigen::Vector3d& p_mm, const Eigen::Vector3d& normal) const {
  const Eigen::Vector3d p = scanner_from_model_ * p_mm;
  const Eigen::Vector3f start = (p_mm + clearance_mm_ * normal).cast<float>();
  const auto margin = static_cast<float>(clearance_mm_);
  const Eigen::Vector3d laser = model_from_scanner_ * source(scanner_.view.laser_mm, p);
  if (occluders_->occluded(start, laser.cast<float>(), margin)) {
    return false;
  }
  if (!scanner_.view.camera_mm) {
    return true;
  }
  const Eigen::Vector3d camera = model_from_scanner_ * source(scanner_.view.camera_mm, p);
  return !occluders_->occluded(start, camera.cast<float>(), margin);
}

}  // namespace dubsar
