// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/mesh_part.h"
#include "ui/gl/frame_target.h"
#include "ui/gl/shader_program.h"
#include "ui/view/bit_marks.h"
#include "ui/view/mesh_buffers.h"
#include "ui/view/orbit_camera.h"
#include "ui/view/piece_size.h"

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
/// gl_VertexID. Main thread.
class MeshSelecting {
 public:
  /// The most elements that the graphics driver lets a shader look up by number: beyond it reads would be
  /// wrong without a word. At least 65 536; a hundred million and more on cards of today.
  [[nodiscard]] static std::size_t most();
  /// The mesh has at most most() faces and vertices, and lives as long as this.
  MeshSelecting(const MeshBuffers& mesh, MeshElement of);
  ~MeshSelecting();
  MeshSelecting(const MeshSelecting&) = delete;
  MeshSelecting& operator=(const MeshSelecting&) = delete;

  /// A polygon more. `seen`: a picture of that size by `camera`, when only what is seen in it is
  /// meant; null for all. A face belongs to a polygon when its middle does.
  void begin(const OrbitCamera& camera, const std::vector<std::uint8_t>& mask, int width, int height,
             const FrameTarget* seen, SelectionStep step);
  /// Some more elements, so many that a frame stays short. True while more is to come; until then all else
  /// stays as it was before the polygon.
  bool go_on();
  void set(SelectionMarks selected);
  [[nodiscard]] MeshElement of() const { return of_; }
  /// Buffer texture of BitMarks::words(). Nothing is in it while selected() is null.
  [[nodiscard]] unsigned texture() const { return textures_[current_]; }
  /// Null while nothing was.
  [[nodiscard]] const SelectionMarks& selected() const { return selected_; }
  /// Of the graphics card's memory.
  [[nodiscard]] std::size_t bytes() const {
    return 2 * 4 * words() + mask_.bytes() + depth_.bytes() + no_picture_.bytes();
  }
  /// A polygon was begun and is not through.
  [[nodiscard]] bool is_under_way() const { return words_.has_value(); }

 private:
  [[nodiscard]] std::size_t words() const { return BitMarks::words_for(count_); }
  void draw(std::size_t count);

  ShaderProgram program_;
  MeshElement of_;
  std::size_t count_;
  unsigned no_vertices_ = 0;
  unsigned buffers_[2] = {0, 0};
  unsigned textures_[2] = {0, 0};
  unsigned mesh_textures_[2] = {0, 0};  ///< positions; corners of faces, or normals of vertices
  std::size_t current_ = 0;
  SelectionMarks selected_;
  std::optional<std::vector<std::uint32_t>> words_;  ///< of the polygon under way, so far
  std::size_t drawn_ = 0;                            ///< words of it
  PieceSize at_a_time_{std::size_t{1} << 18U};
  PixelTexture mask_;
  FrameTarget depth_{{}};  ///< of what was seen
  FrameTarget no_picture_{{PixelFormat::kRgba8}};
};

}  // namespace dubsar::ui
