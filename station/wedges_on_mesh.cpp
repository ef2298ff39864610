// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/wedges_on_mesh.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>

#include "core/near_cells.h"

namespace dubsar {

namespace {

using Corners = std::array<Eigen::Vector3d, 3>;

double from_edge(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double square = along.squaredNorm();
  const double share = square > 0 ? std::clamp((p - a).dot(along) / square, 0.0, 1.0) : 0.0;
  return (a + share * along - p).norm();
}

double from_triangle(const Eigen::Vector3d& p, const Corners& t) {
  const Eigen::Vector3d normal = (t[1] - t[0]).cross(t[2] - t[0]);
  bool is_above = normal.squaredNorm() > 0;
  double off = INFINITY;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d& a = t[k];
    const Eigen::Vector3d& b = t[(k + 1) % 3];
    is_above = is_above && normal.dot((b - a).cross(p - a)) >= 0;
    off = std::min(off, from_edge(p, a, b));
  }
  return is_above ? std::abs((p - t[0]).dot(normal)) / normal.norm() : off;
}

/// Of places with a reach of their own, those that some face comes as near to as that.
class Reached {
 public:
  explicit Reached(const std::vector<Wedge>& wedges) {
    for (const Wedge& wedge : wedges) {
      if (wedge.depth_point_mm.allFinite() && std::isfinite(wedge.depth_mm) && wedge.depth_mm > 0) {
        places_.push_back({wedge.depth_point_mm, wedge.depth_mm / 3});
        longest_mm_ = std::max(longest_mm_, places_.back().reach_mm);
      }
    }
    cells_ = NearCells(longest_mm_ + kSmallFaceMm);
    for (std::size_t k = 0; k < places_.size(); ++k) {
      cells_.add(places_[k].at_mm, k);
    }
    all_.resize(places_.size());
    std::iota(all_.begin(), all_.end(), std::size_t{0});
  }
  void add(const Corners& face) {
    const Eigen::Vector3d middle = (face[0] + face[1] + face[2]) / 3;
    double radius_mm = 0;
    for (const Eigen::Vector3d& corner : face) {
      radius_mm = std::max(radius_mm, (corner - middle).norm());
    }
    if (!std::isfinite(radius_mm)) {
      return;
    }
    for (const std::size_t k : radius_mm <= kSmallFaceMm ? cells_.about(middle) : std::span(all_)) {
      Place& place = places_[k];
      if (!place.is_reached && (place.at_mm - middle).norm() <= place.reach_mm + radius_mm &&
          from_triangle(place.at_mm, face) <= place.reach_mm) {
        place.is_reached = true;
        ++count_;
      }
    }
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] std::size_t all() const { return places_.size(); }
  [[nodiscard]] bool are_enough() const { return 4 * count_ >= 3 * places_.size(); }

 private:
  static constexpr double kSmallFaceMm = 0.5;
  struct Place {
    Eigen::Vector3d at_mm;
    double reach_mm;
    bool is_reached = false;
  };
  std::vector<Place> places_;
  std::vector<std::size_t> all_;
  double longest_mm_ = 0;
  NearCells cells_{1};
  std::size_t count_ = 0;
};

}  // namespace

std::optional<Error> of_another_mesh(const std::vector<Wedge>& wedges, const Mesh& mesh,
                                     const std::string& where) {
  Reached reached(wedges);
  const auto corner = [&](std::uint32_t v) -> Eigen::Vector3d { return mesh.positions[v].cast<double>(); };
  for (std::size_t f = 0; f < mesh.faces.size() && !reached.are_enough(); ++f) {
    const auto& face = mesh.faces[f];
    reached.add({corner(face[0]), corner(face[1]), corner(face[2])});
  }
  for (std::size_t v = 0; mesh.faces.empty() && v < mesh.positions.size() && !reached.are_enough(); ++v) {
    const Eigen::Vector3d point = mesh.positions[v].cast<double>();
    reached.add({point, point, point});
  }
  if (reached.are_enough()) {
    return std::nullopt;
  }
  return Error{ErrorKind::kBadInput,
               fmt::format("these wedges are not shown: only {:.0f} % of them lie on this mesh, so they are "
                           "another one's, or it was moved or has another unit since",
                           std::floor(100.0 * static_cast<double>(reached.count()) /
                                      static_cast<double>(reached.all()))),
               where, "measure them on this mesh"};
}

}  // namespace dubsar
