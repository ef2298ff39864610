// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/model_faces.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "planning/convex_hull.h"

namespace dubsar {

namespace {

const PlacedScan* lowest(std::span<const PlacedScan> scans, bool with_nominal) {
  const PlacedScan* first = nullptr;
  for (const PlacedScan& s : scans) {
    if ((!with_nominal || s.grid->nominal) && (first == nullptr || s.id < first->id)) {
      first = &s;
    }
  }
  return first;
}

/// The direction itself or its opposite, whichever is nearer to the wish.
Eigen::Vector3d turned_towards(const Eigen::Vector3d& direction, const Eigen::Vector3d& wish) {
  return direction.dot(wish) < 0 ? Eigen::Vector3d(-direction) : direction;
}

/// How the hull's surface lies about its middle. By area: how many corners an edge has is chance.
Eigen::Matrix3d spread_of(const Mesh& hull) {
  double area = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (const auto& f : hull.faces) {
    const Eigen::Vector3d a = hull.positions[f[0]].cast<double>();
    const Eigen::Vector3d b = hull.positions[f[1]].cast<double>();
    const Eigen::Vector3d c = hull.positions[f[2]].cast<double>();
    const double weight = 0.5 * (b - a).cross(c - a).norm();
    const Eigen::Vector3d sum = a + b + c;
    area += weight;
    mean += weight / 3.0 * sum;
    moment +=
        weight / 12.0 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
  return moment / area - mean * mean.transpose() / (area * area);
}

/// Of what is as wide as high, the axes in its plane are chance: a square's corners lead to its diagonal.
constexpr double kLongerOfVariance = 1.1;  // 5 % longer

/// The scanner's y axis, or its x where y runs across the faces, laid into the plane across z.
Eigen::Vector3d in_plane(const Eigen::Matrix3d& scanner, const Eigen::Vector3d& z) {
  const bool y_runs_across = std::abs(z.dot(scanner.col(1))) > 0.9;
  const Eigen::Vector3d axis = scanner.col(y_runs_across ? 0 : 1);
  return (axis - z * z.dot(axis)).normalized();
}

}  // namespace

Eigen::Vector3d ModelFaces::normal(Face face) const {
  switch (face) {
    case Face::kObverse:
      return model_from_faces.col(2);
    case Face::kReverse:
      return -model_from_faces.col(2);
    case Face::kLeft:
      return -model_from_faces.col(0);
    case Face::kRight:
      return model_from_faces.col(0);
    case Face::kTop:
      return model_from_faces.col(1);
    case Face::kBottom:
      break;
  }
  return -model_from_faces.col(1);
}

Face ModelFaces::of(const Eigen::Vector3d& normal_in_model) const {
  const Eigen::Vector3d n = model_from_faces.transpose() * normal_in_model;
  int axis = 2;
  for (const int k : {1, 0}) {
    axis = std::abs(n[k]) > std::abs(n[axis]) ? k : axis;
  }
  if (axis == 2) {
    return n.z() < 0 ? Face::kReverse : Face::kObverse;
  }
  if (axis == 1) {
    return n.y() < 0 ? Face::kBottom : Face::kTop;
  }
  return n.x() < 0 ? Face::kLeft : Face::kRight;
}

ModelFaces model_faces(std::span<const PlacedScan> scans, const Mesh& hull) {
  ModelFaces faces;
  if (const PlacedScan* told = lowest(scans, true)) {
    faces.model_from_faces =
        (told->model_from_scanner * told->grid->nominal->tablet_from_scanner.inverse()).rotation;
    return faces;
  }
  const PlacedScan* first = lowest(scans, false);
  if (first == nullptr || hull.faces.empty()) {
    return faces;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread_of(hull));
  const Eigen::Matrix3d scanner = first->model_from_scanner.rotation;
  const Eigen::Vector3d z =
      turned_towards(axes.eigenvectors().col(0), -(scanner * first->grid->view.direction));
  Eigen::Vector3d y = in_plane(scanner, z);
  if (axes.eigenvalues()[2] > kLongerOfVariance * axes.eigenvalues()[1]) {
    const Eigen::Vector3d longer = axes.eigenvectors().col(2);
    const Eigen::Vector3d shorter = axes.eigenvectors().col(1);
    y = turned_towards(std::abs(longer.dot(y)) >= std::abs(shorter.dot(y)) ? longer : shorter, y);
  }
  faces.model_from_faces.col(0) = y.cross(z);
  faces.model_from_faces.col(1) = y;
  faces.model_from_faces.col(2) = z;
  return faces;
}

ModelFaces model_faces(std::span<const PlacedScan> scans, std::span<const Eigen::Vector3f> vertices) {
  return model_faces(scans, convex_hull(hull_points(thinned_for_hull(vertices))));
}

const char* spoken(Face face) {
  constexpr const char* kNames[] = {"the obverse",    "the reverse",  "the left edge",
                                    "the right edge", "the top edge", "the bottom edge"};
  return kNames[static_cast<int>(face)];
}

}  // namespace dubsar
