// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/accuracy/gauge.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <cmath>

namespace dubsar::accuracy {

RigidTransform truth_from_model(const std::vector<PosePair>& pairs) {
  Eigen::Vector3d model_mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d truth_mean = Eigen::Vector3d::Zero();
  double count = 0;
  for (const PosePair& pair : pairs) {
    for (const Eigen::Vector3d& p : pair.points_mm) {
      model_mean += pair.model_from_scanner * p;
      truth_mean += pair.truth_from_scanner * p;
      ++count;
    }
  }
  model_mean /= std::max(count, 1.0);
  truth_mean /= std::max(count, 1.0);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const PosePair& pair : pairs) {
    for (const Eigen::Vector3d& p : pair.points_mm) {
      covariance +=
          (pair.truth_from_scanner * p - truth_mean) * (pair.model_from_scanner * p - model_mean).transpose();
    }
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d fix = Eigen::Matrix3d::Identity();
  fix(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1.0 : 1.0;
  RigidTransform gauge;
  gauge.rotation = svd.matrixU() * fix * svd.matrixV().transpose();
  gauge.translation_mm = truth_mean - gauge.rotation * model_mean;
  return gauge;
}

PoseError pose_error(const PosePair& pair, const RigidTransform& gauge) {
  const RigidTransform moved = gauge * pair.model_from_scanner;
  PoseError error;
  error.rotation_rad = (moved * pair.truth_from_scanner.inverse()).angle_rad();
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  double sum2 = 0;
  for (const Eigen::Vector3d& p : pair.points_mm) {
    centroid += p;
    const double d = (moved * p - pair.truth_from_scanner * p).norm();
    error.displacements_mm.push_back(d);
    sum2 += d * d;
  }
  const double count = std::max<double>(1.0, static_cast<double>(pair.points_mm.size()));
  centroid /= count;
  error.centroid_mm = (moved * centroid - pair.truth_from_scanner * centroid).norm();
  error.rms_mm = std::sqrt(sum2 / count);
  return error;
}

double normalised_error(const ScanPose& pose, const RigidTransform& model_from_scanner_true,
                        const Eigen::Vector3d& centroid_mm) {
  const RigidTransform off = pose.model_from_scanner * model_from_scanner_true.inverse();
  const Eigen::AngleAxisd turn(off.rotation);
  const Eigen::Vector3d at = model_from_scanner_true * centroid_mm;
  Eigen::Matrix<double, 6, 1> twist;
  twist << turn.angle() * turn.axis(), off * at - at;
  return twist.dot(pose.covariance->ldlt().solve(twist)) / 6.0;
}

}  // namespace dubsar::accuracy
