// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <pcl/point_types.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>
#include <pcl/search/kdtree.h>

#include "bench/accuracy/peers.h"

namespace dubsar::bench {

namespace {

using Cloud = pcl::PointCloud<pcl::PointNormal>;
using Tree = pcl::search::KdTree<pcl::PointNormal>;
using Gicp = pcl::GeneralizedIterativeClosestPoint<pcl::PointNormal, pcl::PointNormal>;

struct Prepared {
  Cloud::Ptr cloud{new Cloud};
  Tree::Ptr tree{new Tree};
  Gicp::MatricesVectorPtr covariances{new Gicp::MatricesVector};
};

/// A disc across the normal, as generalized ICP takes a surface to be (Segal et al. 2009).
Eigen::Matrix3d disc(const Eigen::Vector3d& normal) {
  return Eigen::Matrix3d::Identity() - (1.0 - 1e-3) * normal * normal.transpose();
}

std::vector<Prepared> prepare(const std::vector<PublishedScan>& scans) {
  std::vector<Prepared> out(scans.size());
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const PeerPoints from = peer_points(*scans[k].grid);
    for (std::size_t i = 0; i < from.points_mm.size(); ++i) {
      pcl::PointNormal point;
      point.getVector3fMap() = from.points_mm[i].cast<float>();
      point.getNormalVector3fMap() = from.normals[i].cast<float>();
      out[k].cloud->push_back(point);
      out[k].covariances->push_back(disc(from.normals[i]));
    }
    out[k].tree->setInputCloud(out[k].cloud);
  }
  return out;
}

/// Runs the stages of one registration.
template <class Icp>
RigidTransform aligned(Icp& icp, const RigidTransform& start, std::span<const double> stages_mm) {
  Eigen::Matrix4f pose = Eigen::Matrix4f::Identity();
  pose.topLeftCorner<3, 3>() = start.rotation.cast<float>();
  pose.topRightCorner<3, 1>() = start.translation_mm.cast<float>();
  Cloud moved;
  for (const double reach_mm : stages_mm) {
    icp.setMaxCorrespondenceDistance(reach_mm);
    icp.setMaximumIterations(50);
    icp.setTransformationEpsilon(1e-8);
    icp.align(moved, pose);
    pose = icp.getFinalTransformation();
  }
  RigidTransform out;
  out.rotation = pose.topLeftCorner<3, 3>().cast<double>();
  out.translation_mm = pose.topRightCorner<3, 1>().cast<double>();
  return out.orthonormalised();
}

}  // namespace

std::vector<PairMethod> pcl_methods(const std::vector<PublishedScan>& scans) {
  const double before_s = cpu_s();
  const auto prepared = std::make_shared<const std::vector<Prepared>>(prepare(scans));
  const double prepare_ms = 1e3 * (cpu_s() - before_s) / static_cast<double>(scans.size());
  const auto plane = [prepared](std::span<const double> stages_mm) {
    return [prepared, stages_mm](std::size_t on, std::size_t moved, const RigidTransform& start) {
      pcl::IterativeClosestPointWithNormals<pcl::PointNormal, pcl::PointNormal> icp;
      icp.setInputSource((*prepared)[moved].cloud);
      icp.setInputTarget((*prepared)[on].cloud);
      icp.setSearchMethodTarget((*prepared)[on].tree, true);
      return aligned(icp, start, stages_mm);
    };
  };
  const auto generalized = [prepared](std::span<const double> stages_mm) {
    return [prepared, stages_mm](std::size_t on, std::size_t moved, const RigidTransform& start) {
      Gicp icp;
      icp.setInputSource((*prepared)[moved].cloud);
      icp.setInputTarget((*prepared)[on].cloud);
      icp.setSearchMethodTarget((*prepared)[on].tree, true);
      icp.setSourceCovariances((*prepared)[moved].covariances);
      icp.setTargetCovariances((*prepared)[on].covariances);
      return aligned(icp, start, stages_mm);
    };
  };
  return {{"PCL point-to-plane, 3 stages", prepare_ms, plane(kThreeStages)},
          {"PCL point-to-plane, 1 stage", prepare_ms, plane(kOneStage)},
          {"PCL GICP, 3 stages", prepare_ms, generalized(kThreeStages)},
          {"PCL GICP, 1 stage", prepare_ms, generalized(kOneStage)}};
}

}  // namespace dubsar::bench
