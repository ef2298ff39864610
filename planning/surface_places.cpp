// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/surface_places.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace dubsar {

namespace {

constexpr std::size_t kGrain = 1 << 14;
constexpr float kCubesAlong = 25;

struct Triangle {
  Eigen::Vector3f area_normal{0, 0, 0};  ///< as long as the area
  std::uint32_t cube = 0;
  bool sound = false;
  bool measured = false;
};

/// Which way the surface looks, by cube of space.
class CoarseNormals {
 public:
  explicit CoarseNormals(const Mesh& mesh) {
    for (const Eigen::Vector3f& p : mesh.positions) {
      if (p.allFinite()) {
        box_.extend(p);
      }
    }
    if (!box_.isEmpty()) {
      side_mm_ = std::max(box_.sizes().maxCoeff() / kCubesAlong, 1e-6F);
      count_ = ((box_.sizes() / side_mm_).array().floor().cast<int>() + 1).matrix();
    }
    sums_.assign(static_cast<std::size_t>(count_.prod()), Eigen::Vector3d::Zero());
  }
  [[nodiscard]] std::uint32_t cube_of(const Eigen::Vector3f& p) const {
    const Eigen::Vector3i at =
        ((p - box_.min()) / side_mm_).array().floor().cast<int>().max(0).min((count_.array() - 1)).matrix();
    return static_cast<std::uint32_t>((at.z() * count_.y() + at.y()) * count_.x() + at.x());
  }
  void add(const Triangle& t) { sums_[t.cube] += t.area_normal.cast<double>(); }
  [[nodiscard]] const std::vector<Eigen::Vector3d>& sums() const { return sums_; }

 private:
  Eigen::AlignedBox3f box_;
  float side_mm_ = 1;
  Eigen::Vector3i count_{1, 1, 1};
  std::vector<Eigen::Vector3d> sums_;
};

Triangle triangle_of(const Mesh& mesh, const std::array<std::uint32_t, 3>& face,
                     const CoarseNormals& normals) {
  Triangle t;
  for (const std::uint32_t v : face) {
    if (v >= mesh.positions.size() || !mesh.positions[v].allFinite()) {
      return t;
    }
  }
  const Eigen::Vector3f& a = mesh.positions[face[0]];
  const Eigen::Vector3f& b = mesh.positions[face[1]];
  const Eigen::Vector3f& c = mesh.positions[face[2]];
  t.area_normal = 0.5F * (b - a).cross(c - a);
  t.cube = normals.cube_of((a + b + c) / 3.0F);
  t.sound = true;
  t.measured = mesh.flags.empty() || std::none_of(face.begin(), face.end(), [&](std::uint32_t v) {
                 return (mesh.flags[v] & kVertexInterpolated) != 0;
               });
  return t;
}

/// A point of the triangle for the k-th place: the plane's most evenly spread sequence (Roberts 2018),
/// folded into the triangle.
Eigen::Vector2f barycentric(std::size_t k) {
  constexpr double kPlastic = 1.32471795724474602596;
  double whole = 0;
  double u = std::modf(0.5 + static_cast<double>(k) / kPlastic, &whole);
  double v = std::modf(0.5 + static_cast<double>(k) / (kPlastic * kPlastic), &whole);
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  return {static_cast<float>(u), static_cast<float>(v)};
}

}  // namespace

SurfacePlaces surface_places(const Mesh& mesh, const ModelFaces& faces, std::size_t count) {
  SurfacePlaces out;
  CoarseNormals coarse(mesh);
  std::vector<Triangle> triangles(mesh.faces.size());
  parallel_for_each_index(
      triangles.size(), [&](std::size_t f) { triangles[f] = triangle_of(mesh, mesh.faces[f], coarse); },
      kGrain);
  double seen_mm2 = 0;
  for (const Triangle& t : triangles) {
    if (t.sound) {
      coarse.add(t);
      seen_mm2 += t.measured ? static_cast<double>(t.area_normal.norm()) : 0.0;
    }
  }
  std::vector<Face> face_of_cube;
  face_of_cube.reserve(coarse.sums().size());
  for (const Eigen::Vector3d& sum : coarse.sums()) {
    face_of_cube.push_back(faces.of(sum));
  }
  const std::vector<Eigen::Vector3f> own =
      mesh.normals.size() == mesh.positions.size() ? std::vector<Eigen::Vector3f>() : vertex_normals(mesh);
  const std::vector<Eigen::Vector3f>& normals = own.empty() ? mesh.normals : own;

  const double step_mm2 = count > 0 ? seen_mm2 / static_cast<double>(count) : 0.0;
  double passed_mm2 = 0;
  double next_mm2 = 0.5 * step_mm2;
  out.places.reserve(count + 1);
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    const Triangle& t = triangles[f];
    if (!t.sound) {
      continue;
    }
    const double area_mm2 = static_cast<double>(t.area_normal.norm());
    const Face face = face_of_cube[t.cube];
    (t.measured ? out.seen_mm2 : out.interpolated_mm2)[static_cast<std::size_t>(face)] += area_mm2;
    if (!t.measured || !(step_mm2 > 0)) {
      continue;
    }
    passed_mm2 += area_mm2;
    for (; next_mm2 < passed_mm2 && out.places.size() <= count; next_mm2 += step_mm2) {
      const auto& [a, b, c] = mesh.faces[f];
      const Eigen::Vector2f w = barycentric(out.places.size());
      const float wa = 1.0F - w.x() - w.y();
      SurfacePlace place;
      place.position_mm = wa * mesh.positions[a] + w.x() * mesh.positions[b] + w.y() * mesh.positions[c];
      const Eigen::Vector3f n = wa * normals[a] + w.x() * normals[b] + w.y() * normals[c];
      place.normal = n.norm() > 1e-6F ? Eigen::Vector3f(n.normalized()) : t.area_normal.normalized();
      place.face = face;
      out.places.push_back(place);
    }
  }
  return out;
}

}  // namespace dubsar
