// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/region_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "archive/scale_bar.h"

namespace dubsar {

namespace {

constexpr int kSidePx = 232;
constexpr double kLeastMm = 6;      ///< a wedge and its neighbours: small enough to see, large enough to find
constexpr double kMostMm = 30;      ///< unless the place itself is larger
constexpr double kRoomRound = 3;    ///< of the picture's side to the region's
constexpr double kLeastRoom = 1.6;  ///< for the ring
constexpr double kShadowMm = 4;
constexpr Rgb8 kRing{20, 60, 200};
constexpr Rgb8 kBarInk{24, 24, 24};

double diameter_mm(const RedRegion& region) {
  const double area_mm2 = std::isfinite(region.area_mm2) ? std::max(0.0, region.area_mm2) : 0.0;
  return 2 * std::sqrt(area_mm2 / std::numbers::pi);
}

/// The triangles beside and behind a place as it is looked at, with their vertices alone. What lies far
/// before it would hide it; what lies behind is seen through cracks.
Mesh cut_out(const Mesh& mesh, const Eigen::Vector3f& center, const Eigen::Vector3f& towards_viewer,
             float radius_mm) {
  constexpr std::uint32_t kAbsent = 0xffffffffU;
  const auto is_near = [&](const Eigen::Vector3f& p) {
    const Eigen::Vector3f d = p - center;
    const float before = d.dot(towards_viewer);
    return before <= radius_mm && (d - before * towards_viewer).squaredNorm() <= radius_mm * radius_mm;
  };
  Mesh out;
  std::vector<std::uint32_t> taken(mesh.positions.size(), kAbsent);
  const bool has_normals = mesh.normals.size() == mesh.positions.size();
  const bool has_flags = mesh.flags.size() == mesh.positions.size();
  for (const auto& face : mesh.faces) {
    if (face[0] >= mesh.positions.size() || face[1] >= mesh.positions.size() ||
        face[2] >= mesh.positions.size() || !is_near(mesh.positions[face[0]])) {
      continue;
    }
    std::array<std::uint32_t, 3> kept{};
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& v = taken[face[k]];
      if (v == kAbsent) {
        v = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(mesh.positions[face[k]]);
        if (has_normals) {
          out.normals.push_back(mesh.normals[face[k]]);
        }
        if (has_flags) {
          out.flags.push_back(mesh.flags[face[k]]);
        }
      }
      kept[k] = v;
    }
    out.faces.push_back(kept);
  }
  return out;
}

ColouredPoints marks_near(const ColouredPoints& marks, const Eigen::Vector3f& center, float radius_mm) {
  ColouredPoints out;
  out.radius_mm = 0.5F * marks.radius_mm;  // the clay below should still be seen
  out.bury_mm = marks.bury_mm;
  const bool has_colours = marks.colours.size() == marks.positions_mm.size();
  for (std::size_t i = 0; i < marks.positions_mm.size(); ++i) {
    if ((marks.positions_mm[i] - center).norm() <= radius_mm) {
      out.positions_mm.push_back(marks.positions_mm[i]);
      out.colours.push_back(has_colours ? marks.colours[i] : kRedOfSparse);
    }
  }
  return out;
}

}  // namespace

void draw_ring(Image& image, double x, double y, double radius_px, double thickness_px, Rgb8 colour) {
  const double reach = radius_px + thickness_px;
  for (int j = static_cast<int>(std::floor(y - reach)); j <= static_cast<int>(std::ceil(y + reach)); ++j) {
    for (int i = static_cast<int>(std::floor(x - reach)); i <= static_cast<int>(std::ceil(x + reach)); ++i) {
      const double off = std::abs(std::hypot(i + 0.5 - x, j + 0.5 - y) - radius_px) - 0.5 * thickness_px;
      const double cover = std::clamp(0.5 - off, 0.0, 1.0);
      if (cover <= 0 || !image.inside(i, j)) {
        continue;
      }
      const std::size_t at = image.offset(i, j);
      for (std::size_t k = 0; k < 3; ++k) {
        const double mixed = image.bytes[at + k] + cover * (colour[k] - image.bytes[at + k]);
        image.bytes[at + k] = static_cast<std::uint8_t>(std::lround(mixed));
      }
    }
  }
}

Eigen::Vector3d outlook(const Mesh& mesh, const RedRegion& region) {
  constexpr double kLeastReachMm = 1.5;
  constexpr double kAgreement = 0.3;  ///< of the normals; below it they point every way, as round a thin rim
  const auto reach_mm = static_cast<float>(std::max(kLeastReachMm, diameter_mm(region)));
  const Eigen::Vector3f center = region.center_mm.cast<float>();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double area = 0;
  for (const auto& [a, b, c] : mesh.faces) {
    if (a >= mesh.positions.size() || b >= mesh.positions.size() || c >= mesh.positions.size() ||
        !((mesh.positions[a] - center).squaredNorm() <= reach_mm * reach_mm)) {
      continue;
    }
    const Eigen::Vector3d n =
        (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]).cast<double>();
    if (n.allFinite()) {
      sum += n;
      area += n.norm();
    }
  }
  // Where nobody has seen the side that is missing, the nearest clay is that of the side opposite.
  const bool agrees = sum.norm() > kAgreement * area && sum.dot(region.normal) >= -kAgreement * sum.norm();
  return agrees ? Eigen::Vector3d(sum.normalized()) : region.normal;
}

Face face_towards(const Eigen::Vector3d& direction, const RigidTransform& tablet_from_model) {
  Face best = Face::kObverse;
  double most = -2;
  for (int f = 0; f < kFaceCount; ++f) {
    const Eigen::Matrix3d view = face_camera(static_cast<Face>(f), tablet_from_model).view_from_model;
    if (const double towards = view.row(2).dot(direction); towards > most) {
      most = towards;
      best = static_cast<Face>(f);
    }
  }
  return best;
}

Result<Image> region_picture(const Mesh& mesh, const ColouredPoints& marks, const RedRegion& region,
                             const Eigen::Vector3d& towards_viewer, const RigidTransform& tablet_from_model,
                             const JobContext& job) {
  const double across_mm = diameter_mm(region);
  const double side_mm =
      std::clamp(kRoomRound * across_mm, kLeastMm, std::max(kMostMm, kLeastRoom * across_mm));
  const Eigen::Vector3f center = region.center_mm.cast<float>();
  const auto reach_mm = static_cast<float>(0.75 * side_mm + kShadowMm);
  const Mesh near = cut_out(mesh, center, towards_viewer.cast<float>(), reach_mm);
  const ColouredPoints points = marks_near(marks, center, reach_mm);
  const ViewCamera face = face_camera(face_towards(towards_viewer, tablet_from_model), tablet_from_model);
  const ViewCamera camera = free_camera(towards_viewer, face.view_from_model.row(1).transpose());

  RenderOptions options;
  options.style = RenderStyle::kRedMap;
  options.mm_per_px = side_mm / kSidePx;
  options.window = RenderWindow{region.center_mm, side_mm, side_mm};
  const RenderScene scene(near, points.positions_mm.empty() ? nullptr : &points);
  Image image;
  if (scene.empty()) {  // nothing was ever meshed near it
    image = filled_image(kSidePx, kSidePx, options.background);
    image.mm_per_px = options.mm_per_px;
  } else {
    Result<Image> drawn = render(scene, camera, options, job);
    if (!drawn) {
      return drawn;
    }
    image = std::move(*drawn);
  }
  const double radius_px = std::max(9.0, 0.65 * across_mm / options.mm_per_px);
  draw_ring(image, 0.5 * image.width, 0.5 * image.height, radius_px + 1, 3.5, kPaper);
  draw_ring(image, 0.5 * image.width, 0.5 * image.height, radius_px + 1, 1.8, kRing);
  const ScaleBar bar = scale_bar_for(image.mm_per_px, image.width);
  const int left = 6;
  const int top = image.height - bar.height_px - 6;
  fill_rectangle(image, left - 3, top - 3, bar.width_px + 6, bar.height_px + 6, kPaper);
  draw_scale_bar(image, bar, left, top, kBarInk);
  return image;
}

}  // namespace dubsar
