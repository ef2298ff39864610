// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/cross_section.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>

namespace dubsar {

namespace {

using Point = CrossSection::Point;

/// A point, and where it is seen: across the view from the first place towards the second, and up to the
/// viewer.
struct SeenPoint : Point {
  double across_mm = 0;
  double up_mm = 0;
};

/// What stands less above a point does not hide it, mm: two copies of one surface.
constexpr double kSame_mm = 1e-6;

/// The cut as a graph: a point for each edge of the mesh that crosses the plane, a link for each face.
class Cut {
 public:
  Cut(const Mesh& mesh, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
      const Eigen::Vector3d& towards)
      : mesh_(mesh), from_(from), towards_(towards) {
    const Eigen::Vector3d line = to - from;
    along_ = line.normalized();
    across_ = (line - line.dot(towards) * towards).normalized();
    width_ = across_.dot(line);
    normal_ = across_.cross(towards);
    height_ = normal_.cross(along_);
  }

  void take_faces() {
    std::vector<double> side(mesh_.positions.size());
    for (std::size_t v = 0; v < side.size(); ++v) {
      side[v] = normal_.dot(mesh_.positions[v].cast<double>() - from_);
    }
    for (const auto& face : mesh_.faces) {
      const auto above = [&](std::size_t k) { return side[face[k]] >= 0; };
      if ((above(0) == above(1) && above(1) == above(2)) || !looks_up(face)) {
        continue;
      }
      std::array<std::size_t, 2> ends{};
      std::size_t found = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        if (above(k) != above(next)) {
          ends[found++] = node(face[k], face[next], side);
        }
      }
      link(ends[0], ends[1]);
    }
  }

  /// Takes away what something else stands before: of a tablet on a plate the plate.
  void hide_what_is_behind() {
    std::vector<std::pair<std::size_t, std::size_t>> segments;
    for (std::size_t a = 0; a < links_.size(); ++a) {
      for (const std::size_t b : links_[a]) {
        if (points_[a].across_mm < points_[b].across_mm) {
          segments.emplace_back(a, b);
        }
      }
    }
    if (segments.empty()) {
      return;
    }
    const auto [least, most] = std::ranges::minmax_element(points_, {}, &SeenPoint::across_mm);
    const double start = least->across_mm;
    const double step = std::max((most->across_mm - start) / static_cast<double>(segments.size()), kSame_mm);
    const auto bin = [&](double across) { return static_cast<std::size_t>((across - start) / step); };
    std::vector<std::vector<std::size_t>> over(bin(most->across_mm) + 1);
    for (std::size_t k = 0; k < segments.size(); ++k) {
      for (std::size_t at = bin(points_[segments[k].first].across_mm);
           at <= bin(points_[segments[k].second].across_mm); ++at) {
        over[at].push_back(k);
      }
    }
    std::vector<bool> hidden(points_.size(), false);
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const SeenPoint& p = points_[k];
      hidden[k] = std::ranges::any_of(over[bin(p.across_mm)], [&](std::size_t s) {
        const SeenPoint& a = points_[segments[s].first];
        const SeenPoint& b = points_[segments[s].second];
        const double part = (p.across_mm - a.across_mm) / (b.across_mm - a.across_mm);
        return part >= 0 && part <= 1 && a.up_mm + part * (b.up_mm - a.up_mm) > p.up_mm + kSame_mm;
      });
    }
    for (std::size_t k = 0; k < links_.size(); ++k) {
      std::erase_if(links_[k], [&](std::size_t other) { return hidden[k] || hidden[other]; });
    }
  }

  [[nodiscard]] std::vector<std::vector<Point>> lines() {
    std::vector<std::vector<Point>> out;
    std::vector<bool> walked(points_.size(), false);
    // From open ends first, then what is left are rings.
    for (const bool ends_only : {true, false}) {
      for (std::size_t start = 0; start < points_.size(); ++start) {
        if (!walked[start] && (!ends_only || links_[start].size() == 1)) {
          add_clipped(walk(start, walked), out);
        }
      }
    }
    std::ranges::sort(out, {}, [](const std::vector<Point>& line) { return line.front().along_mm; });
    return out;
  }

 private:
  [[nodiscard]] bool looks_up(const std::array<std::uint32_t, 3>& face) const {
    const auto p = [&](std::size_t k) { return mesh_.positions[face[k]].cast<double>(); };
    return (p(1) - p(0)).cross(p(2) - p(0)).dot(towards_) > 0;
  }

  std::size_t node(std::uint32_t a, std::uint32_t b, const std::vector<double>& side) {
    const auto [low, high] = std::minmax(a, b);
    const std::uint64_t key = (std::uint64_t{low} << 32U) | high;
    const auto [at, is_new] = node_of_.try_emplace(key, points_.size());
    if (is_new) {
      const double part = side[low] / (side[low] - side[high]);
      const Eigen::Vector3d p = mesh_.positions[low].cast<double>();
      const Eigen::Vector3d q = mesh_.positions[high].cast<double>();
      const Eigen::Vector3d place = p + part * (q - p);
      const Eigen::Vector3d off = place - from_;
      points_.push_back({{along_.dot(off), height_.dot(off), place}, across_.dot(off), towards_.dot(off)});
      links_.emplace_back();
    }
    return at->second;
  }

  void link(std::size_t a, std::size_t b) {
    links_[a].push_back(b);
    links_[b].push_back(a);
  }

  std::vector<SeenPoint> walk(std::size_t start, std::vector<bool>& walked) const {
    std::vector<SeenPoint> line;
    std::optional<std::size_t> at = start;
    while (at) {
      walked[*at] = true;
      line.push_back(points_[*at]);
      std::optional<std::size_t> next;
      for (const std::size_t other : links_[*at]) {
        next = next || walked[other] ? next : std::optional(other);
      }
      at = next;
    }
    if (line.front().across_mm > line.back().across_mm) {
      std::ranges::reverse(line);
    }
    return line;
  }

  /// What of a line is seen between the two places, ends interpolated.
  void add_clipped(const std::vector<SeenPoint>& line, std::vector<std::vector<Point>>& out) const {
    const auto inside = [&](const SeenPoint& p) { return p.across_mm >= 0 && p.across_mm <= width_; };
    const auto between = [&](const SeenPoint& a, const SeenPoint& b, double edge) {
      const double t = (edge - a.across_mm) / (b.across_mm - a.across_mm);
      return Point{a.along_mm + t * (b.along_mm - a.along_mm), a.height_mm + t * (b.height_mm - a.height_mm),
                   a.place_mm + t * (b.place_mm - a.place_mm)};
    };
    std::vector<Point> piece;
    const auto finish = [&] {
      if (piece.size() > 1) {
        out.push_back(std::move(piece));
      }
      piece.clear();
    };
    for (std::size_t k = 0; k < line.size(); ++k) {
      if (k > 0) {  // both ends may lie in one long face
        const SeenPoint& before = line[k - 1];
        const SeenPoint& after = line[k];
        const bool onwards = before.across_mm < after.across_mm;
        for (const double edge : {onwards ? 0 : width_, onwards ? width_ : 0}) {
          if ((before.across_mm < edge) != (after.across_mm < edge)) {
            piece.push_back(between(before, after, edge));
          }
        }
      }
      if (inside(line[k])) {
        piece.push_back(line[k]);
      } else {
        finish();
      }
    }
    finish();
  }

  const Mesh& mesh_;
  Eigen::Vector3d from_, towards_;
  Eigen::Vector3d along_, height_;   ///< of the line between the two places, and square to it in the plane
  Eigen::Vector3d across_, normal_;  ///< across the view, and of the plane
  double width_ = 0;                 ///< between the two places across the view
  std::unordered_map<std::uint64_t, std::size_t> node_of_;
  std::vector<SeenPoint> points_;
  std::vector<std::vector<std::size_t>> links_;
};

}  // namespace

Result<CrossSection> cross_section(const Mesh& mesh, const Eigen::Vector3d& from_mm,
                                   const Eigen::Vector3d& to_mm, const Eigen::Vector3d& towards) {
  const double size = towards.norm();
  if (!(size > 0) || !std::isfinite(size) || !from_mm.allFinite() || !to_mm.allFinite()) {
    return fail(ErrorKind::kUsage, "the cut has no direction", "cross-section",
                "give three numbers, not all zero");
  }
  const Eigen::Vector3d up = towards / size;
  const Eigen::Vector3d line = to_mm - from_mm;
  if ((line - line.dot(up) * up).norm() < 1e-6) {
    return fail(ErrorKind::kUsage, "the two places of the cut lie above each other", "cross-section",
                "choose places beside each other, as the surface is seen");
  }
  Cut cut(mesh, from_mm, to_mm, up);
  cut.take_faces();
  cut.hide_what_is_behind();
  CrossSection out;
  out.length_mm = line.norm();
  out.last_along_mm = out.length_mm;
  out.lines = cut.lines();
  bool first = true;
  for (const auto& piece : out.lines) {
    for (const Point& point : piece) {
      if (first || point.height_mm < out.lowest_mm) {
        out.lowest_mm = point.height_mm;
        out.lowest_along_mm = point.along_mm;
      }
      out.highest_mm = first ? point.height_mm : std::max(out.highest_mm, point.height_mm);
      out.first_along_mm = std::min(out.first_along_mm, point.along_mm);
      out.last_along_mm = std::max(out.last_along_mm, point.along_mm);
      first = false;
    }
  }
  return out;
}

}  // namespace dubsar
