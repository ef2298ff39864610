// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "triangulation/half_edges.h"
#include "triangulation/tiling.h"

namespace dubsar {

/// Bits of Sheet::marks.
enum SheetMark : std::uint8_t {
  kLooseMark = 1,   ///< measured and without a face: gaps may be closed of it
  kSparseMark = 2,  ///< clay is missing there: the red map shows it
};

/// A mesh under construction: what seams and gaps need to know of each vertex. Faces form an oriented
/// edge-manifold (no half-edge twice).
struct Sheet {
  std::vector<Eigen::Vector3f> positions;  ///< mm
  std::vector<Eigen::Vector3f> normals;    ///< unit, as measured, not from the faces
  std::vector<float> spacing_mm;           ///< µ of the scan that a vertex comes from
  std::vector<float> sigma_mm;             ///< standard deviation along the normal
  std::vector<Triangle> faces;
  std::vector<std::uint8_t> marks;  ///< SheetMark; or empty
  /// 0 for vertices of which some faces are elsewhere: an edge between two of them is not open, whatever it
  /// looks like. Empty: all faces are here.
  std::vector<std::uint8_t> whole;
  /// Nothing outside of it may be changed, nor looked at to decide what to change: others do so there.
  Eigen::AlignedBox3f room = everywhere();

  /// Whether all that lies within radius_mm of a place lies in the room.
  [[nodiscard]] bool has_room(const Eigen::Vector3f& p_mm, float radius_mm) const {
    return lies_within(room, p_mm, radius_mm);
  }
};

/// Half-edges a→b to look up; open addressing in one array.
class HalfEdgeSet {
 public:
  [[nodiscard]] bool contains(std::uint32_t a, std::uint32_t b) const {
    return !slots_.empty() && slots_[slot_of(key_of(a, b))] != kEmpty;
  }
  /// False when it was there.
  bool insert(std::uint32_t a, std::uint32_t b);
  void reserve(std::size_t count);

 private:
  static constexpr std::uint64_t kEmpty = ~std::uint64_t{0};
  [[nodiscard]] static std::uint64_t key_of(std::uint32_t a, std::uint32_t b) {
    return (static_cast<std::uint64_t>(a) << 32U) | b;
  }
  [[nodiscard]] std::size_t slot_of(std::uint64_t key) const {
    std::uint64_t mixed = key * 0x9e3779b97f4a7c15ULL;
    mixed ^= mixed >> 32U;
    std::size_t slot = mixed & (slots_.size() - 1);
    while (slots_[slot] != kEmpty && slots_[slot] != key) {
      slot = (slot + 1) & (slots_.size() - 1);
    }
    return slot;
  }

  std::vector<std::uint64_t> slots_;  ///< a power of two, at most half full
  std::size_t count_ = 0;
};

/// The open edges of a sheet and the vertices on them, kept up to date while faces are added. An open edge
/// (a, b) is the half-edge a→b of a face whose opposite b→a belongs to no face; a face on its free side runs
/// b→a. Refuses whatever would use a half-edge twice.
class Front {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffU;
  /// Refers to the sheet; faces must be added through add_face() while the front lives.
  explicit Front(Sheet& sheet);

  struct Edge {
    std::uint32_t a = 0, b = 0;
  };

  [[nodiscard]] std::vector<Edge> open_edges() const;
  [[nodiscard]] bool is_open(std::uint32_t a, std::uint32_t b) const;
  /// On an open edge, or a vertex without any face that add_vertex() or offer_vertex() brought.
  [[nodiscard]] bool on_front(std::uint32_t v) const;
  /// Then or earlier.
  [[nodiscard]] bool was_on_front(std::uint32_t v) const { return find(v) != nullptr; }
  [[nodiscard]] std::span<const std::uint32_t> out_of(std::uint32_t v) const;  ///< heads of open edges from v
  [[nodiscard]] std::span<const std::uint32_t> into(std::uint32_t v) const;    ///< tails of open edges to v

  /// True when face abc uses no half-edge that a face has already.
  [[nodiscard]] bool accepts(const Triangle& f) const;
  /// accepts() must hold.
  void add_face(const Triangle& f);
  std::uint32_t add_vertex(const Eigen::Vector3f& position_mm, const Eigen::Vector3f& normal,
                           float spacing_mm, float sigma_mm);
  /// Brings in a vertex of the sheet that has no face.
  void offer_vertex(std::uint32_t v) { links(v).free = true; }

  /// A vertex that is, or was, on the front.
  struct Links {
    std::uint32_t vertex = 0;
    std::uint32_t next_in_bucket = kNone;  ///< index into links_
    Eigen::Vector3f position{0, 0, 0};     ///< and what else is asked of those near by: as in the sheet
    Eigen::Vector3f normal{0, 0, 0};
    bool free = false;                   ///< without a face
    std::vector<std::uint32_t> out, in;  ///< heads of open edges from it, tails of those to it
  };
  /// Those of the front within the ball, in a fixed order. They hold until a face or a vertex is added. False
  /// where more than kMostMet are, or were, on the front thereabouts: those are no rims of a surface, their
  /// spacing is not the one that they are said to have (rows and columns that are mixed up), and to look at
  /// all of them for each would take for ever. Where a scan of 0.05 mm meets one of 0.5 mm there are some
  /// hundreds.
  [[nodiscard]] bool near(const Eigen::Vector3f& p_mm, float radius_mm, std::vector<const Links*>& out) const;
  static constexpr std::size_t kMostMet = 8192;

  /// Counts faces that were added.
  [[nodiscard]] std::size_t changes() const { return changes_; }
  /// changes() as it was when a face with a vertex in buckets that meet the box was last added; 0: never.
  [[nodiscard]] std::size_t last_change(const Eigen::AlignedBox3f& box_mm) const;

  /// Walks along open edges around each opening, in the direction of the faces beside it. Where several open
  /// edges leave one vertex the walk goes on along the next one across the opening.
  struct Walk {
    std::vector<std::uint32_t> vertices;
    bool leaves = false;  ///< the sheet, through a vertex that is not whole
  };
  [[nodiscard]] std::vector<Walk> walks() const;
  /// Those that do not leave.
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> openings() const;

  [[nodiscard]] const Sheet& sheet() const { return *sheet_; }

 private:
  struct Bucket {
    std::uint64_t key = ~std::uint64_t{0};
    std::uint32_t first = kNone;  ///< index into links_
    std::size_t changed = 0;      ///< changes() when a face last took a vertex in here
  };
  using Cell = std::array<int, 3>;
  [[nodiscard]] Cell cell_of(const Eigen::Vector3f& p) const;
  [[nodiscard]] static std::uint64_t key_of(const Cell& cell);
  [[nodiscard]] std::size_t slot_of(const Cell& cell, std::uint64_t& key) const;
  void grow_buckets();
  Links& links(std::uint32_t v);
  [[nodiscard]] const Links* find(std::uint32_t v) const;

  Sheet* sheet_;
  float cells_per_mm_ = 1;
  std::size_t changes_ = 0;
  std::vector<std::uint32_t> link_of_;  ///< [V] index into links_, or kNone
  std::vector<Links> links_;
  HalfEdgeSet half_edges_;       ///< of faces, between vertices of the front
  std::vector<Bucket> buckets_;  ///< open addressing, a power of two long
};

}  // namespace dubsar
