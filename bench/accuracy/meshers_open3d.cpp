// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <open3d/camera/PinholeCameraIntrinsic.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/geometry/RGBDImage.h>
#include <open3d/geometry/TriangleMesh.h>
#include <open3d/pipelines/integration/ScalableTSDFVolume.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "bench/accuracy/meshers.h"
#include "core/mesh_query.h"
#include "core/parallel.h"

namespace dubsar::bench {

namespace {

using open3d::geometry::PointCloud;

PointCloud cloud_of(const MesherInput& input) {
  PointCloud cloud;
  for (const auto& scan : input.scans) {
    for (std::size_t v = 0; v < scan.mesh.positions.size(); ++v) {
      cloud.points_.push_back(scan.mesh.positions[v].cast<double>());
      cloud.normals_.push_back(scan.mesh.normals[v].cast<double>());
    }
  }
  return cloud;
}

Mesh from_open3d(const open3d::geometry::TriangleMesh& mesh) {
  Mesh out;
  out.positions.reserve(mesh.vertices_.size());
  for (const Eigen::Vector3d& p : mesh.vertices_) {
    out.positions.push_back(p.cast<float>());
  }
  out.faces.reserve(mesh.triangles_.size());
  for (const Eigen::Vector3i& t : mesh.triangles_) {
    out.faces.push_back({static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                         static_cast<std::uint32_t>(t[2])});
  }
  return out;
}

/// What a pinhole camera far off in the viewing direction sees of one scan, a pixel for each µ.
struct DepthImage {
  open3d::geometry::RGBDImage image;
  open3d::camera::PinholeCameraIntrinsic intrinsic;
  Eigen::Matrix4d camera_from_model;
};

DepthImage depth_image(const MesherInput::Scan& scan, double spacing_mm) {
  constexpr double kAwayMm = 300;
  const Eigen::Vector3d look = scan.model_from_scanner.rotation * scan.grid->view.direction;
  Eigen::Vector3d centre(0, 0, 0);
  for (const Eigen::Vector3f& p : scan.mesh.positions) {
    centre += p.cast<double>();
  }
  centre /= static_cast<double>(std::max<std::size_t>(scan.mesh.positions.size(), 1));
  Eigen::Matrix3d rotation;  // rows: the camera's x, y, z in the model frame
  rotation.row(2) = look.normalized();
  rotation.row(0) = look.unitOrthogonal();
  rotation.row(1) = rotation.row(2).cross(rotation.row(0));
  const Eigen::Vector3d eye = centre - kAwayMm * look.normalized();
  const double focal_px = kAwayMm / spacing_mm;
  double half_px = 1;
  for (const Eigen::Vector3f& p : scan.mesh.positions) {
    const Eigen::Vector3d q = rotation * (p.cast<double>() - eye);
    half_px = std::max({half_px, std::abs(q.x() / q.z()), std::abs(q.y() / q.z())});
  }
  half_px = std::ceil(half_px * focal_px) + 2;
  const int side = 2 * static_cast<int>(half_px);

  DepthImage out;
  out.intrinsic = {side, side, focal_px, focal_px, half_px, half_px};
  out.camera_from_model = Eigen::Matrix4d::Identity();
  out.camera_from_model.topLeftCorner<3, 3>() = rotation;
  out.camera_from_model.topRightCorner<3, 1>() = -rotation * eye;
  out.image.depth_.Prepare(side, side, 1, 4);
  out.image.color_.Prepare(side, side, 3, 1);
  const MeshQuery query(scan.mesh);
  auto* depth = reinterpret_cast<float*>(out.image.depth_.data_.data());
  parallel_for_each_index(static_cast<std::size_t>(side), [&](std::size_t row) {
    for (int col = 0; col < side; ++col) {
      const Eigen::Vector3d ray((col - half_px) / focal_px, (static_cast<double>(row) - half_px) / focal_px,
                                1.0);
      const Eigen::Vector3d direction = (rotation.transpose() * ray).normalized();
      const auto hit = query.first_hit(eye.cast<float>(), direction.cast<float>(), 0.0F, 2 * kAwayMm);
      depth[row * static_cast<std::size_t>(side) + static_cast<std::size_t>(col)] =
          hit ? static_cast<float>(hit->distance_mm / ray.norm()) : 0.0F;
    }
  });
  return out;
}

Mesh tsdf(const MesherInput& input) {
  namespace integration = open3d::pipelines::integration;
  constexpr double kBandCells = 4;
  integration::ScalableTSDFVolume volume(input.spacing_mm, kBandCells * input.spacing_mm,
                                         integration::TSDFVolumeColorType::NoColor);
  for (const auto& scan : input.scans) {
    const DepthImage view = depth_image(scan, input.spacing_mm);
    volume.Integrate(view.image, view.intrinsic, view.camera_from_model);
  }
  return from_open3d(*volume.ExtractTriangleMesh());
}

}  // namespace

std::vector<Mesher> open3d_meshers(const std::vector<int>& poisson_depths) {
  std::vector<Mesher> out;
  for (const int depth : poisson_depths) {
    out.push_back({"Poisson, depth " + std::to_string(depth), [depth](const MesherInput& input) {
                     const auto [mesh, densities] =
                         open3d::geometry::TriangleMesh::CreateFromPointCloudPoisson(
                             cloud_of(input), static_cast<std::size_t>(depth));
                     return std::optional(from_open3d(*mesh));
                   }});
  }
  out.push_back({"ball pivoting", [](const MesherInput& input) {
                   const double mu = input.spacing_mm;
                   return std::optional(
                       from_open3d(*open3d::geometry::TriangleMesh::CreateFromPointCloudBallPivoting(
                           cloud_of(input), {mu, 2 * mu, 4 * mu})));
                 }});
  out.push_back({"TSDF, cells of µ", [](const MesherInput& input) { return std::optional(tsdf(input)); }});
  return out;
}

}  // namespace dubsar::bench
