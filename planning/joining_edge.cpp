// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/joining_edge.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "planning/model_faces.h"
#include "planning/surface_cover.h"

namespace dubsar {

namespace {

/// A bit of surface in the frame of the faces: x to the right edge, y to the top edge, z out of the obverse.
struct Bit {
  Eigen::Vector3d p_mm;
  Eigen::Vector3d n;
};

/// Steeper surface is none of the side's.
constexpr double kOfSide = 0.5;
constexpr double kStripShare = 0.25;
/// At both ends of an edge the next rim bends away along it, which is no relief.
constexpr double kCornerShare = 0.15;
/// Less than this part of what the side shows beside the edge, beyond it: what was seen ends there.
constexpr double kHardlyAny = 0.5;

/// Heights over a plane, in cells.
class HeightCells {
 public:
  /// `along_mm` runs along the edge, `across_mm` across it.
  void add(double along_mm, double across_mm, double height_mm) {
    Cell& cell = cells_[{cell_of(across_mm), cell_of(along_mm)}];
    cell.sum_mm += height_mm;
    ++cell.count;
  }
  /// Squares of the height against what lies 1.5 mm to both sides along the edge, summed.
  [[nodiscard]] double relief_mm2() const {
    constexpr int kAside = 3;
    double sum = 0;
    for (const auto& [key, cell] : cells_) {
      const auto before = cells_.find({key.first, key.second - kAside});
      const auto after = cells_.find({key.first, key.second + kAside});
      if (before != cells_.end() && after != cells_.end()) {
        const double height_mm = cell.mean_mm() - 0.5 * (before->second.mean_mm() + after->second.mean_mm());
        sum += height_mm * height_mm;
      }
    }
    return sum;
  }

 private:
  struct Cell {
    double sum_mm = 0;
    int count = 0;
    [[nodiscard]] double mean_mm() const { return sum_mm / count; }
  };
  static constexpr double kCellMm = 0.5;
  static std::int64_t cell_of(double mm) { return static_cast<std::int64_t>(std::floor(mm / kCellMm)); }

  std::map<std::pair<std::int64_t, std::int64_t>, Cell> cells_;
};

/// Where the surface ends to both sides along an axis; stray bits are no end of it.
std::pair<double, double> ends_mm(const std::vector<Bit>& bits, int axis) {
  constexpr std::size_t kStrays = 500;  // one in so many, to each side
  std::vector<double> at;
  at.reserve(bits.size());
  for (const Bit& bit : bits) {
    at.push_back(bit.p_mm[axis]);
  }
  const auto low = at.begin() + static_cast<std::ptrdiff_t>(at.size() / kStrays);
  const auto high = at.end() - 1 - static_cast<std::ptrdiff_t>(at.size() / kStrays);
  std::ranges::nth_element(at, low);
  const double low_mm = *low;
  std::ranges::nth_element(at, high);
  return {low_mm, *high};
}

/// Relief at the edge at the end `way` (+1, -1) of an axis (0: x, 1: y); nothing where the other side was
/// seen beyond it. `up`: +1 where the obverse is what was seen, -1 the reverse.
std::optional<double> relief_at(const std::vector<Bit>& bits, int axis, double way, double up) {
  const auto [low_mm, high_mm] = ends_mm(bits, axis);
  const double end_mm = way > 0 ? high_mm : -low_mm;
  const double strip_mm = kStripShare * (high_mm - low_mm);
  const int along = 1 - axis;
  const auto [from_mm, to_mm] = ends_mm(bits, along);
  const double corner_mm = kCornerShare * (to_mm - from_mm);
  HeightCells on_side;
  HeightCells on_edge;
  std::size_t seen = 0;
  std::size_t beyond = 0;
  for (const Bit& bit : bits) {
    const double inward_mm = end_mm - way * bit.p_mm[axis];
    if (inward_mm > strip_mm || bit.p_mm[along] < from_mm + corner_mm ||
        bit.p_mm[along] > to_mm - corner_mm) {
      continue;
    }
    if (up * bit.n.z() > kOfSide) {
      ++seen;
      on_side.add(bit.p_mm[along], inward_mm, bit.p_mm.z());
    } else if (up * bit.n.z() < -kOfSide) {
      ++beyond;
    } else if (way * bit.n[axis] > kOfSide) {
      on_edge.add(bit.p_mm[along], bit.p_mm.z(), way * bit.p_mm[axis]);
    }
  }
  if (static_cast<double>(beyond) > kHardlyAny * static_cast<double>(seen)) {
    return std::nullopt;
  }
  return on_side.relief_mm2() + on_edge.relief_mm2();
}

}  // namespace

std::optional<JoiningEdge> joining_edge(std::span<const PlacedScan> model) {
  const SurfaceCover cover(model);
  std::vector<Eigen::Vector3f> vertices;
  vertices.reserve(cover.size());
  for (const SurfaceCover::Element& element : cover.elements()) {
    vertices.push_back(element.position_mm);
  }
  if (vertices.empty()) {
    return std::nullopt;
  }
  const ModelFaces faces = model_faces(model, vertices);
  const Eigen::Matrix3d faces_from_model = faces.model_from_faces.transpose();
  std::vector<Bit> bits;
  bits.reserve(cover.size());
  std::size_t obverse = 0;
  std::size_t reverse = 0;
  for (const SurfaceCover::Element& element : cover.elements()) {
    const Bit& bit = bits.emplace_back(Bit{faces_from_model * element.position_mm.cast<double>(),
                                           faces_from_model * element.normal.cast<double>()});
    obverse += bit.n.z() > kOfSide ? 1 : 0;
    reverse += bit.n.z() < -kOfSide ? 1 : 0;
  }
  const double up = obverse >= reverse ? 1 : -1;
  std::optional<JoiningEdge> best;
  double most_mm2 = -1;
  for (const Face face : {Face::kLeft, Face::kRight, Face::kTop, Face::kBottom}) {
    const bool is_x = face == Face::kLeft || face == Face::kRight;
    const double way = face == Face::kRight || face == Face::kTop ? 1 : -1;
    const std::optional<double> relief_mm2 = relief_at(bits, is_x ? 0 : 1, way, up);
    if (relief_mm2 && *relief_mm2 > most_mm2) {
      most_mm2 = *relief_mm2;
      best = JoiningEdge{face, faces.normal(face), faces.normal(up > 0 ? Face::kObverse : Face::kReverse)};
    }
  }
  return best;
}

}  // namespace dubsar
