// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/mesh_part.h"
#include "ui/gl/frame_target.h"
#include "ui/gl/shader_program.h"
#include "ui/view/mesh_buffers.h"

namespace dubsar::ui {

/// How what a polygon holds goes together with what was selected before.
enum class SelectionStep { kUnion, kIntersection, kDifference };

/// Which pixels of a picture lie inside a polygon (even-odd), 255 or 0, bottom row first as OpenGL has it.
/// Corners in pixels from the top left.
[[nodiscard]] std::vector<std::uint8_t> polygon_mask(const std::vector<Eigen::Vector2f>& corners, int width,
                                                     int height);

/// The faces of a mesh that are selected, or its vertices (seed 000, section 2): a constructive combination
/// of polygons on the screen, each in a view of its own, worked out on the graphics card where the mesh lies
/// and recorded by transform feedback into a buffer that the next picture reads by gl_PrimitiveID, or by
/// gl_VertexID. A number per face in the order of ShownMesh::faces, or per vertex. Main thread.
class MeshSelecting {
 public:
  /// The most elements that the graphics driver lets a shader look up by number: beyond it reads would be
  /// wrong without a word. At least 65 536; a hundred million and more on cards of today.
  [[nodiscard]] static std::size_t most();
  /// `count` of at most most().
  MeshSelecting(MeshElement of, std::size_t count);
  ~MeshSelecting();
  MeshSelecting(const MeshSelecting&) = delete;
  MeshSelecting& operator=(const MeshSelecting&) = delete;

  /// `depth`: the depth texture of a picture of that size under `clip_from_model`, when only what is seen in
  /// it is meant; 0 for all. A face belongs to a polygon when its middle does.
  void apply(const MeshBuffers& mesh, const Eigen::Matrix4f& clip_from_model,
             const std::vector<std::uint8_t>& mask, int width, int height, unsigned depth,
             SelectionStep step);
  /// [count] 1 for the selected.
  void set(const std::vector<std::uint32_t>& selected);
  [[nodiscard]] MeshElement of() const { return of_; }
  /// Buffer texture of one 32-bit number each, 1 for the selected.
  [[nodiscard]] unsigned texture() const { return textures_[current_]; }
  /// [count] 1 for the selected; waits for the card.
  [[nodiscard]] std::vector<std::uint32_t> read() const;

 private:
  ShaderProgram program_;
  MeshElement of_;
  std::size_t count_;
  unsigned buffers_[2] = {0, 0};
  unsigned textures_[2] = {0, 0};
  std::size_t current_ = 0;
  PixelTexture mask_;
  FrameTarget no_picture_{{PixelFormat::kRgba8}};
};

}  // namespace dubsar::ui
