// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/render_scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "core/parallel.h"

namespace dubsar {

namespace {

constexpr std::size_t kGrain = 1 << 15;

bool is_sound(const Mesh& mesh, const RenderScene::Face3& face) {
  return std::all_of(face.begin(), face.end(), [&](std::uint32_t v) {
    return v < mesh.positions.size() && mesh.positions[v].allFinite();
  });
}

std::vector<Eigen::Vector3f> normals_of(const Mesh& mesh, std::span<const RenderScene::Face3> faces) {
  std::vector<Eigen::Vector3f> normals(mesh.positions.size(), Eigen::Vector3f::Zero());
  for (const auto& [a, b, c] : faces) {
    const Eigen::Vector3f n =
        (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
    normals[a] += n;
    normals[b] += n;
    normals[c] += n;
  }
  for (Eigen::Vector3f& n : normals) {
    n.stableNormalize();
  }
  return normals;
}

struct Box {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());

  void add(const Eigen::Vector3d& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  void add(const Box& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
};

}  // namespace

RenderScene::RenderScene(const Mesh& mesh, const ColouredPoints* points) : mesh_(&mesh), points_(points) {
  using Count = std::size_t;
  const Count bad = parallel_reduce_ordered<Count>(
      mesh.faces.size(), kGrain, 0,
      [&](std::size_t begin, std::size_t end) {
        return static_cast<Count>(std::count_if(mesh.faces.begin() + static_cast<std::ptrdiff_t>(begin),
                                                mesh.faces.begin() + static_cast<std::ptrdiff_t>(end),
                                                [&](const Face3& face) { return !is_sound(mesh, face); }));
      },
      [](Count& total, const Count& chunk) { total += chunk; });
  if (bad > 0) {
    all_sound_ = false;
    sound_faces_.reserve(mesh.faces.size() - bad);
    std::copy_if(mesh.faces.begin(), mesh.faces.end(), std::back_inserter(sound_faces_),
                 [&](const Face3& face) { return is_sound(mesh, face); });
  }
  if (mesh.normals.size() != mesh.positions.size()) {
    own_normals_ = normals_of(mesh, faces());
  }
  if (points_ != nullptr && std::none_of(points_->positions_mm.begin(), points_->positions_mm.end(),
                                         [](const Eigen::Vector3f& p) { return p.allFinite(); })) {
    points_ = nullptr;
  }
}

RenderScene::Extent RenderScene::extent(const ViewCamera& camera) const {
  const Eigen::Matrix3d& rotation = camera.view_from_model;
  const auto face_list = faces();
  Box box = parallel_reduce_ordered<Box>(
      face_list.size(), kGrain, Box{},
      [&](std::size_t begin, std::size_t end) {
        Box part;
        for (std::size_t i = begin; i < end; ++i) {
          for (const std::uint32_t v : face_list[i]) {
            part.add(rotation * mesh_->positions[v].cast<double>());
          }
        }
        return part;
      },
      [](Box& total, const Box& chunk) { total.add(chunk); });
  if (points_ != nullptr) {
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(std::max(0.0F, points_->radius_mm));
    for (const Eigen::Vector3f& p : points_->positions_mm) {
      if (p.allFinite()) {
        const Eigen::Vector3d centre = rotation * p.cast<double>();
        box.add(centre - reach);
        box.add(centre + reach);
      }
    }
  }
  return empty() ? Extent{} : Extent{box.low, box.high};
}

}  // namespace dubsar
