// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/mesh_part.h"
#include "ui/gl/frame_target.h"
#include "ui/gl/shader_program.h"
#include "ui/view/mesh_buffers.h"
#include "ui/view/piece_size.h"

namespace dubsar::ui {

/// How what a polygon holds goes together with what was selected before.
enum class SelectionStep { kUnion, kIntersection, kDifference };

/// Which pixels of a picture lie inside a polygon (even-odd), 255 or 0, bottom row first as OpenGL has it.
/// Corners in pixels from the top left.
[[nodiscard]] std::vector<std::uint8_t> polygon_mask(const std::vector<Eigen::Vector2f>& corners, int width,
                                                     int height);

/// A number per face in the order of ShownMesh::faces, or per vertex: 1 for the selected.
using SelectionMarks = std::shared_ptr<const std::vector<std::uint32_t>>;

/// The faces of a mesh that are selected, or its vertices (seed 000, section 2): a constructive combination
/// of polygons on the screen, each in a view of its own, worked out on the graphics card where the mesh lies
/// and recorded by transform feedback into a buffer that the next picture reads by gl_PrimitiveID, or by
/// gl_VertexID. Main thread.
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

  /// A polygon more. `seen`: a picture of that size under `clip_from_model`, when only what is seen in it is
  /// meant; null for all. A face belongs to a polygon when its middle does.
  void begin(const Eigen::Matrix4f& clip_from_model, const std::vector<std::uint8_t>& mask, int width,
             int height, const FrameTarget* seen, SelectionStep step);
  /// Some more elements, so many that a frame stays short. True while more is to come; until then all else
  /// stays as it was before the polygon.
  bool go_on(const MeshBuffers& mesh);
  void set(SelectionMarks selected);
  [[nodiscard]] MeshElement of() const { return of_; }
  /// Buffer texture of one 32-bit number each, 1 for the selected. Nothing is in it while selected() is null.
  [[nodiscard]] unsigned texture() const { return textures_[current_]; }
  /// Null while nothing was.
  [[nodiscard]] const SelectionMarks& selected() const { return selected_; }
  /// Of the graphics card's memory.
  [[nodiscard]] std::size_t bytes() const {
    return 2 * 4 * count_ + mask_.bytes() + depth_.bytes() + no_picture_.bytes();
  }
  /// A polygon was begun and is not through.
  [[nodiscard]] bool is_under_way() const { return marks_ != nullptr; }

 private:
  void draw(const MeshBuffers& mesh, std::size_t count);

  ShaderProgram program_;
  MeshElement of_;
  std::size_t count_;
  unsigned buffers_[2] = {0, 0};
  unsigned textures_[2] = {0, 0};
  std::size_t current_ = 0;
  SelectionMarks selected_;
  std::shared_ptr<std::vector<std::uint32_t>> marks_;  ///< of the polygon under way, so far
  std::size_t drawn_ = 0;                              ///< of it
  PieceSize at_a_time_{std::size_t{1} << 18U};
  PixelTexture mask_;
  FrameTarget depth_{{}};  ///< of what was seen
  FrameTarget no_picture_{{PixelFormat::kRgba8}};
};

}  // namespace dubsar::ui
