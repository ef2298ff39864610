// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <open3d/geometry/PointCloud.h>
#include <open3d/pipelines/registration/GeneralizedICP.h>
#include <open3d/pipelines/registration/Registration.h>

#include "bench/accuracy/peers.h"

namespace dubsar::bench {

namespace {

namespace o3d = open3d::pipelines::registration;
using open3d::geometry::PointCloud;

/// One point cloud per scan; its search tree is built anew in each call, as the library does it.
std::vector<PointCloud> prepare(const std::vector<PublishedScan>& scans) {
  std::vector<PointCloud> out(scans.size());
  for (std::size_t k = 0; k < scans.size(); ++k) {
    PeerPoints from = peer_points(*scans[k].grid);
    out[k].points_ = std::move(from.points_mm);
    out[k].normals_ = std::move(from.normals);
  }
  return out;
}

template <class Step>
RigidTransform in_stages(const RigidTransform& start, std::span<const double> stages_mm, const Step& step) {
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  pose.topLeftCorner<3, 3>() = start.rotation;
  pose.topRightCorner<3, 1>() = start.translation_mm;
  for (const double reach_mm : stages_mm) {
    pose = step(pose, reach_mm);
  }
  RigidTransform out;
  out.rotation = pose.topLeftCorner<3, 3>();
  out.translation_mm = pose.topRightCorner<3, 1>();
  return out.orthonormalised();
}

}  // namespace

std::vector<PairMethod> open3d_methods(const std::vector<PublishedScan>& scans) {
  const double before_s = cpu_s();
  const auto prepared = std::make_shared<const std::vector<PointCloud>>(prepare(scans));
  const double prepare_ms = 1e3 * (cpu_s() - before_s) / static_cast<double>(scans.size());
  const o3d::ICPConvergenceCriteria criteria(1e-6, 1e-6, 50);
  const auto plane = [prepared, criteria](std::span<const double> stages_mm) {
    return [=](std::size_t on, std::size_t moved, const RigidTransform& start) {
      return in_stages(start, stages_mm, [&](const Eigen::Matrix4d& pose, double reach_mm) {
        return o3d::RegistrationICP((*prepared)[moved], (*prepared)[on], reach_mm, pose,
                                    o3d::TransformationEstimationPointToPlane(), criteria)
            .transformation_;
      });
    };
  };
  const auto generalized = [prepared, criteria](std::span<const double> stages_mm) {
    return [=](std::size_t on, std::size_t moved, const RigidTransform& start) {
      return in_stages(start, stages_mm, [&](const Eigen::Matrix4d& pose, double reach_mm) {
        return o3d::RegistrationGeneralizedICP((*prepared)[moved], (*prepared)[on], reach_mm, pose,
                                               o3d::TransformationEstimationForGeneralizedICP(), criteria)
            .transformation_;
      });
    };
  };
  return {{"Open3D point-to-plane, 3 stages", prepare_ms, plane(kThreeStages)},
          {"Open3D point-to-plane, 1 stage", prepare_ms, plane(kOneStage)},
          {"Open3D GICP, 3 stages", prepare_ms, generalized(kThreeStages)},
          {"Open3D GICP, 1 stage", prepare_ms, generalized(kOneStage)}};
}

}  // namespace dubsar::bench
