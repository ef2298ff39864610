// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "archive/render_scene.h"
#include "ui/view/shown_mesh.h"

namespace dubsar::ui {

/// A mesh in the memory of the graphics card: each vertex once, faces by index. Main thread.
class MeshBuffers {
 public:
  /// Says what it will hold; upload() takes the memory for it and fills it from `mesh`, whose numbers must
  /// stay where they are until it is done.
  explicit MeshBuffers(const ShownMesh& mesh);
  ~MeshBuffers();
  MeshBuffers(const MeshBuffers&) = delete;
  MeshBuffers& operator=(const MeshBuffers&) = delete;

  /// The graphics card has no room for it; it is not to be drawn then.
  [[nodiscard]] bool is_refused() const { return refused_; }
  /// Some more of the mesh, so much that a frame stays short. (Where the processor draws, taking the memory
  /// is what takes long.)
  void upload();
  [[nodiscard]] bool is_uploaded() const { return rooms_.empty() && parts_.empty(); }

  /// A number per vertex, [V], for the overlay that shows numbers.
  void set_values(const std::vector<float>& values);
  /// Other traits for the same vertices.
  void set_traits(const std::vector<std::array<std::uint8_t, 4>>& traits);
  /// Its faces and vertices are those of the mesh that it shows, not of a coarser level.
  [[nodiscard]] bool is_whole() const { return whole_; }
  [[nodiscard]] bool has_values() const { return has_values_; }
  [[nodiscard]] bool has_colours() const { return has_colours_; }
  [[nodiscard]] bool points_only() const { return faces_ == 0; }
  [[nodiscard]] std::size_t faces() const { return faces_; }
  [[nodiscard]] std::size_t vertices() const { return vertices_; }
  /// Of the graphics card, for all of this.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  /// Buffer texture of the face of the whole surface that each face of a coarser level was made of; those of
  /// `level` begin at first_of().
  [[nodiscard]] unsigned made_of() const { return made_of_; }
  [[nodiscard]] std::size_t first_of(std::size_t level) const { return level_first_[level]; }

  // Buffers of three floats a vertex, packed_normal() of each, and three corners a face, the whole surface
  // first.
  [[nodiscard]] unsigned position_buffer() const;
  [[nodiscard]] unsigned normal_buffer() const;
  [[nodiscard]] unsigned corner_buffer() const { return corner_buffer_; }

  void bind() const;  ///< then one of:
  void draw_faces(std::size_t first, std::size_t count) const;
  void draw_level(std::size_t level, std::size_t first, std::size_t count) const;  ///< of ShownMesh::coarser
  void draw_points(std::size_t first, std::size_t count) const;

 private:
  struct Part {  // that is not on the card yet
    unsigned buffer = 0;
    std::size_t at = 0;  ///< bytes
    const std::byte* data = nullptr;
    std::size_t bytes = 0;
  };
  struct Room {  // that the card has not been asked for yet
    unsigned buffer = 0;
    std::size_t bytes = 0;
  };
  void take_room(const Room& room) const;
  std::vector<Room> rooms_;
  std::vector<Part> parts_;
  unsigned array_ = 0;
  unsigned made_of_ = 0;
  unsigned made_of_buffer_ = 0;
  unsigned corner_buffer_ = 0;
  std::vector<unsigned> buffers_;
  std::vector<std::size_t> level_first_;  ///< faces of coarser levels before each
  std::size_t vertices_, faces_;
  std::size_t bytes_ = 0;
  bool has_values_ = false;
  bool has_colours_ = false;
  bool whole_ = false;
  bool refused_ = false;
};

/// Small discs over the surface. Main thread.
class PointBuffers {
 public:
  explicit PointBuffers(const ColouredPoints& points);
  ~PointBuffers();
  PointBuffers(const PointBuffers&) = delete;
  PointBuffers& operator=(const PointBuffers&) = delete;
  void draw() const;
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }  ///< of the graphics card's memory
  [[nodiscard]] float radius_mm() const { return radius_mm_; }
  [[nodiscard]] float bury_mm() const { return bury_mm_; }

 private:
  unsigned array_ = 0;
  unsigned buffer_ = 0;
  std::size_t count_;
  std::size_t bytes_ = 0;
  float radius_mm_, bury_mm_;
};

}  // namespace dubsar::ui
