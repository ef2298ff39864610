// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "archive/camera.h"
#include "archive/image.h"
#include "core/mesh.h"

namespace dubsar {

/// Points painted over the surface as small discs: red samples, which must show where there is no mesh too.
struct ColouredPoints {
  std::vector<Eigen::Vector3f> positions_mm;  ///< [N], model frame
  std::vector<Eigen::Vector3f>
      normals;                ///< [N] out of the clay, or empty; those seen from behind are left out
  std::vector<Rgb8> colours;  ///< [N], or empty: kRedOfSparse
  float radius_mm = 0.12F;    ///< of a disc
  float bury_mm = 0.4F;       ///< how far below the mesh a point may lie and still show
};

inline constexpr Rgb8 kRedOfSparse{214, 30, 38};
/// Excused samples and interpolated vertices.
inline constexpr Rgb8 kAmberOfExcused{226, 160, 42};

/// What is to be drawn, made ready once for many views: faces that cannot be drawn (an index out of range, a
/// coordinate that is not a number) are left out, and normals are computed where the mesh has none. Refers to
/// the mesh and the points: keep both alive and unmoved.
class RenderScene {
 public:
  using Face3 = std::array<std::uint32_t, 3>;

  explicit RenderScene(const Mesh& mesh, const ColouredPoints* points = nullptr);

  [[nodiscard]] const Mesh& mesh() const { return *mesh_; }
  [[nodiscard]] std::span<const Face3> faces() const {
    return sound_faces_.empty() && all_sound_ ? std::span<const Face3>(mesh_->faces) : sound_faces_;
  }
  [[nodiscard]] std::span<const Eigen::Vector3f> normals() const {
    return own_normals_.empty() ? std::span<const Eigen::Vector3f>(mesh_->normals) : own_normals_;
  }
  /// Null when there are none.
  [[nodiscard]] const ColouredPoints* points() const { return points_; }
  /// No face and no point to draw.
  [[nodiscard]] bool empty() const { return faces().empty() && points_ == nullptr; }

  struct Extent {
    Eigen::Vector3d min_mm{0, 0, 0};
    Eigen::Vector3d max_mm{0, 0, 0};
    [[nodiscard]] Eigen::Vector3d size_mm() const { return max_mm - min_mm; }
  };
  /// Box round everything that is drawn, along the axes of the camera's frame. Zero when empty().
  [[nodiscard]] Extent extent(const ViewCamera& camera) const;

 private:
  const Mesh* mesh_;
  const ColouredPoints* points_;
  bool all_sound_ = true;
  std::vector<Face3> sound_faces_;
  std::vector<Eigen::Vector3f> own_normals_;
};

}  // namespace dubsar
