// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/other_tablet.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "core/random.h"
#include "core/units.h"

namespace dubsar::bench {

namespace {

struct Press {
  Eigen::Vector3d tip;                     ///< depth point
  std::array<Eigen::Vector3d, 3> exits;    ///< counter-clockwise from above; 0 is the tail
  std::array<Eigen::Vector3d, 3> normals;  ///< of faces between exits k and k + 1, upwards
  double depth = 0;
  double rounding = 0.03;  ///< mm over which one face goes over into the next
  double hollow = 0;       ///< of the faces, per mm
  double heap = 0.03;
  double reach = 1;
};

double smooth_max(double a, double b, double width) {
  const double h = std::max(width - std::abs(a - b), 0.0) / width;
  return std::max(a, b) + 0.25 * h * h * width;
}

class Bun {
 public:
  explicit Bun(const OtherTabletOptions& options) : options_(options), random_(seed_for(options.seed, 77)) {
    half_ = {random_.uniform(12, 26), random_.uniform(10, 20)};
    thick_ = random_.uniform(6, 10);
    width_ = random_.uniform(0.9, 2.6);
    broken_.setZero();
    if (options.wear > 0) {
      broken_.y() = random_.uniform(0.6, 1.0);
      broken_.x() = random_.uniform(0.6, 1.0);
      broken_.normalize();
    }
    write();
  }

  /// Height of the unwritten top or bottom over the plane z = 0.
  [[nodiscard]] double body(const Eigen::Vector2d& p) const {
    const double u = p.x() / half_.x();
    const double v = p.y() / half_.y();
    const double q = std::max(0.0, (1 - u * u * u * u) * (1 - v * v * v * v));
    return thick_ * std::pow(q, 0.4) + 0.2 * std::sin(0.21 * p.x() + 0.13 * p.y());
  }
  [[nodiscard]] const std::vector<Press>& presses() const { return presses_; }
  [[nodiscard]] const Eigen::Vector2d& half() const { return half_; }

  /// Height of the written top; the press that made it, or -1; and whether it broke off.
  double top(const Eigen::Vector2d& p, int* owner, std::vector<std::uint32_t>* made, bool* broken) const {
    double z = body(p);
    *owner = -1;
    for (std::size_t k = 0; k < presses_.size(); ++k) {
      const Press& press = presses_[k];
      const Eigen::Vector2d to = p - press.tip.head<2>();
      if (to.squaredNorm() > press.reach * press.reach) {
        continue;
      }
      std::array<double, 3> face{};
      for (std::size_t f = 0; f < 3; ++f) {
        const Eigen::Vector3d& n = press.normals[f];
        face[f] = press.tip.z() - (n.x() * to.x() + n.y() * to.y()) / n.z() - press.hollow * to.squaredNorm();
      }
      const double floor = smooth_max(smooth_max(face[0], face[1], press.rounding), face[2], press.rounding);
      if (floor < z) {
        z = floor;
        *owner = static_cast<int>(k);
        made->push_back(static_cast<std::uint32_t>(k));
      } else {
        // Heaped up beside the head, more on one side than on the other.
        const double rise = floor - z;
        z += press.heap * std::exp(-rise * rise / 0.02) * (1.0 + 0.5 * std::tanh(to.x()));
      }
    }
    const double cut = broken_.dot(p.cwiseQuotient(half_)) - (1.25 - 0.45 * options_.wear);
    *broken = options_.wear > 0 && cut > 0;
    if (*broken) {
      z = std::min(z, body(p) - 6.0 * cut + 0.5 * rough(p, 1.1, 91) + 0.2 * rough(p, 0.35, 92) - 0.05);
      *owner = -1;
    }
    return z + (0.003 + 0.012 * options_.wear) * rough(p, 0.25, 5) + 0.02 * options_.wear * rough(p, 1.3, 6);
  }

 private:
  /// Value noise of about unit amplitude over cells of this size.
  [[nodiscard]] double rough(const Eigen::Vector2d& p, double cell, std::uint64_t salt) const {
    const Eigen::Vector2d at = p / cell;
    const Eigen::Vector2d low = at.array().floor();
    const auto corner = [&](double x, double y) {
      const auto i = static_cast<std::int64_t>(x) + 100000;
      const auto j = static_cast<std::int64_t>(y) + 100000;
      return Random(seed_for(options_.seed ^ salt, static_cast<std::uint64_t>(i * 300007 + j)))
          .uniform(-1, 1);
    };
    const Eigen::Vector2d t = at - low;
    const Eigen::Vector2d s = t.cwiseProduct(t).cwiseProduct(Eigen::Vector2d::Constant(3) - 2 * t);
    const double a = corner(low.x(), low.y()) * (1 - s.x()) + corner(low.x() + 1, low.y()) * s.x();
    const double b = corner(low.x(), low.y() + 1) * (1 - s.x()) + corner(low.x() + 1, low.y() + 1) * s.x();
    return a * (1 - s.y()) + b * s.y();
  }

  void write() {
    const double line = 4.2 * width_;
    for (double y = 0.72 * half_.y(); y > -0.75 * half_.y(); y -= line) {
      for (double x = -0.78 * half_.x(); x < 0.76 * half_.x(); x += random_.uniform(1.0, 2.6) * width_) {
        press({x + random_.uniform(-0.2, 0.2) * width_, y + random_.uniform(-0.35, 0.35) * line});
      }
    }
  }

  void press(const Eigen::Vector2d& head) {
    constexpr std::array<double, 6> kTurns = {0, -90, -90, 0, -45, 45};
    const bool hook = random_.uniform() < 0.15;
    const double straight = hook ? 180 : kTurns[random_.below(6)];
    const double turn = rad_from_deg(straight + 6 * random_.normal());
    const double width = width_ * random_.uniform(0.8, 1.25);
    const double depth = width * random_.uniform(0.28, 0.5);
    const double length = hook ? 0.75 * width : width * random_.uniform(1.4, 3.6);
    const double back = depth * random_.uniform(0.25, 0.8);
    const Eigen::Vector2d along(std::cos(turn), std::sin(turn));
    const Eigen::Vector2d across(-along.y(), along.x());
    const double skew = random_.uniform(-0.25, 0.25);
    const std::array<Eigen::Vector2d, 3> foot = {
        head + length * along,
        head - back * along + (0.5 + 0.2 * skew) * width * across + skew * back * along,
        head - back * along - (0.5 - 0.2 * skew) * width * across - skew * back * along};
    Press p;
    p.depth = depth;
    p.tip = {head.x(), head.y(), body(head) - depth};
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      p.exits[k] = {foot[k].x(), foot[k].y(), body(foot[k])};
      middle += p.exits[k] / 3.0;
      p.reach = std::max(p.reach, (foot[k] - head).norm() + 0.5);
    }
    const double lowest = std::min({p.exits[0].z(), p.exits[1].z(), p.exits[2].z()});
    if (lowest < p.tip.z() + 0.4 * depth) {
      return;  // over the rim: no tetrahedron any more
    }
    for (std::size_t k = 0; k < 3; ++k) {
      p.normals[k] = (p.exits[k] - p.tip).cross(p.exits[(k + 1) % 3] - p.tip).normalized();
      if (p.normals[k].z() < 0.05) {
        return;  // a wall that overhangs: no such stylus
      }
    }
    p.rounding = random_.uniform(0.01, 0.03 + 0.08 * options_.wear) * width;
    p.hollow = random_.uniform(0.0, 0.008);
    p.heap = random_.uniform(0.0, 0.06) * depth;
    presses_.push_back(p);
  }

  OtherTabletOptions options_;
  Random random_;
  Eigen::Vector2d half_;
  double thick_;
  double width_;
  Eigen::Vector2d broken_;
  std::vector<Press> presses_;
};

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

Wedge truth_of(const Press& press, int id) {
  Wedge wedge;
  wedge.id = id;
  wedge.depth_point_mm = press.tip;
  wedge.exit_points_mm = press.exits;
  wedge.outer_vertices_mm = press.exits;
  wedge.face_normals = press.normals;
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d edge = press.exits[k] - press.tip;
    wedge.face_angles_rad[k] = angle_between(edge, press.exits[(k + 1) % 3] - press.tip);
    wedge.opening_angles_rad[k] = kPi - angle_between(press.normals[(k + 2) % 3], press.normals[k]);
    if (edge.norm() > longest) {
      longest = edge.norm();
      wedge.directional_edge = static_cast<int>(k);
    }
  }
  wedge.depth_mm = press.depth;
  return wedge;
}

}  // namespace

sim::SimTablet make_other_tablet(const OtherTabletOptions& options) {
  const Bun bun(options);
  const auto nx = static_cast<std::uint32_t>(2.0 * bun.half().x() / options.spacing_mm) + 1;
  const auto ny = static_cast<std::uint32_t>(2.0 * bun.half().y() / options.spacing_mm) + 1;
  const std::size_t layer = std::size_t{nx} * ny;
  sim::SimTablet tablet;
  Mesh& mesh = tablet.mesh;
  mesh.positions.resize(2 * layer);
  std::vector<int> owner(layer, -1);
  std::vector<std::vector<std::uint32_t>> made(layer);
  std::vector<std::uint8_t> fracture(layer, 0);
  parallel_for_each_index(layer, [&](std::size_t i) {
    const double x = -bun.half().x() + 2.0 * bun.half().x() * static_cast<double>(i % nx) / (nx - 1);
    const double y = -bun.half().y() + 2.0 * bun.half().y() * static_cast<double>(i / nx) / (ny - 1);
    bool broken = false;
    const double z = bun.top({x, y}, &owner[i], &made[i], &broken);
    fracture[i] = broken ? 1 : 0;
    Random random(seed_for(options.seed ^ 0x5eed, i));
    mesh.positions[i] = Eigen::Vector3d(x, y, z + options.noise_mm * random.normal()).cast<float>();
    mesh.positions[layer + i] =
        Eigen::Vector3d(x, y, -bun.body({x, y}) + options.noise_mm * random.normal()).cast<float>();
  });
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({a, c, d});
  };
  for (std::uint32_t j = 0; j + 1 < ny; ++j) {
    for (std::uint32_t i = 0; i + 1 < nx; ++i) {
      const std::uint32_t a = j * nx + i;
      const auto low = static_cast<std::uint32_t>(layer) + a;
      quad(a, a + 1, a + 1 + nx, a + nx);
      quad(low, low + nx, low + nx + 1, low + 1);
    }
  }
  const auto wall = [&](std::uint32_t a, std::uint32_t b) {
    const auto l = static_cast<std::uint32_t>(layer);
    quad(a, l + a, l + b, b);
  };
  for (std::uint32_t i = 0; i + 1 < nx; ++i) {
    wall(i, i + 1);
    wall((ny - 1) * nx + i + 1, (ny - 1) * nx + i);
  }
  for (std::uint32_t j = 0; j + 1 < ny; ++j) {
    wall((j + 1) * nx, j * nx);
    wall(j * nx + nx - 1, (j + 1) * nx + nx - 1);
  }
  mesh.normals = vertex_normals(mesh);
  std::vector<int> once(bun.presses().size());
  std::vector<int> kept(bun.presses().size());
  tablet.kinds.assign(mesh.positions.size(), sim::SurfaceKind::kBody);
  tablet.wedge_of.assign(mesh.positions.size(), -1);
  for (std::size_t i = 0; i < layer; ++i) {
    for (const std::uint32_t k : made[i]) {
      ++once[k];
    }
    if (fracture[i] != 0) {
      tablet.kinds[i] = sim::SurfaceKind::kFracture;
    }
    if (owner[i] >= 0) {
      ++kept[static_cast<std::size_t>(owner[i])];
      tablet.wedge_of[i] = owner[i];
      tablet.kinds[i] = sim::SurfaceKind::kWedge;
    }
  }
  for (std::size_t k = 0; k < once.size(); ++k) {
    Wedge wedge = truth_of(bun.presses()[k], static_cast<int>(k));
    wedge.vertex_count = kept[k];
    wedge.intact = once[k] > 0 ? static_cast<double>(kept[k]) / once[k] : 0.0;
    tablet.wedges.push_back(wedge);
  }
  return tablet;
}

}  // namespace dubsar::bench
