// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/damage.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "sim/noise.h"

namespace dubsar::sim {

namespace {

int how_many(Random& random, double amount, double most) {
  const double mean = amount * most * random.uniform(0.6, 1.2);
  return static_cast<int>(std::floor(mean + random.uniform()));
}

Eigen::Vector3d somewhere(const TabletBody& body, Random& random) {
  const double z = random.uniform() < 0.5 ? -0.6 : 0.6;
  const double y = random.uniform(-1, 1);
  const double x = random.uniform(-1, 1);
  return body.radial(Eigen::Vector3d(x, y, z).cwiseProduct(body.half_size_mm()));
}

}  // namespace

Damage::Damage(const TabletBody& body, const DamageOptions& options, double spacing_mm, std::uint64_t seed)
    : wall_mm_(1.5 * spacing_mm), seed_(seed_for(seed, 31)) {
  Random random(seed_);
  const double small = body.half_size_mm().head<2>().minCoeff();
  const auto patches = [&](double amount, std::vector<Patch>* out) {
    for (int i = 0, n = amount > 0 ? how_many(random, amount, 8) : 0; i < n; ++i) {
      out->push_back({somewhere(body, random), small * random.uniform(0.15, 0.4), random.uniform(0.5, 1.0)});
    }
  };
  patches(options.erosion, &worn_);
  patches(options.dirt, &dirty_);
  for (int i = 0, n = options.cracks > 0 ? how_many(random, options.cracks, 6) : 0; i < n; ++i) {
    Crack crack;
    crack.centre = somewhere(body, random);
    const Eigen::Vector3d any = random.normal3();
    crack.across = body.normal(crack.centre).cross(any).normalized();
    crack.length = small * random.uniform(0.3, 0.9);
    crack.width = std::max(random.uniform(0.12, 0.3), 2.5 * spacing_mm);
    crack.depth = random.uniform(0.25, 0.7);
    crack.depth = options.crack_depth_mm > 0 ? options.crack_depth_mm : crack.depth;
    crack.seed = random.next();
    cracks_.push_back(crack);
  }
  for (int i = 0, n = options.fracture > 0 ? how_many(random, options.fracture, 5) : 0; i < n; ++i) {
    const double corner = random.uniform(0.4, 1.0);
    const double z = random.uniform(-0.8, 0.8);
    const double y = random.uniform() < 0.5 ? -1 : 1;
    const double x = random.uniform() < 0.5 ? -1 : 1;
    Eigen::Vector3d d(x, y, z);
    d[static_cast<int>(random.below(2))] *= corner;
    const Eigen::Vector3d at = body.radial(d.cwiseProduct(body.half_size_mm()));
    const Eigen::Vector3d turn = random.normal3();
    Break broken;
    broken.normal = (at.normalized() + 0.9 * body.normal(at) + 0.18 * turn).normalized();
    broken.offset = broken.normal.dot(at) - small * random.uniform(0.06, 0.2);
    broken.rough_mm = random.uniform(0.35, 0.8);
    broken.seed = random.next();
    breaks_.push_back(broken);
  }
  // Drawn last and from numbers of their own: a tablet with holes is else the tablet without.
  Random boring(seed_for(seed, 32));
  for (int i = 0, n = options.holes > 0 ? how_many(boring, options.holes, 5) : 0; i < n; ++i) {
    Hole hole;
    hole.centre = somewhere(body, boring);
    hole.axis = body.normal(hole.centre);
    hole.radius = boring.uniform(0.5, 1.4);
    hole.depth = std::min(boring.uniform(1.5, 5.0), 0.6 * body.half_size_mm().z());
    hole.radius = options.hole_radius_mm > 0 ? options.hole_radius_mm : hole.radius;
    hole.depth = options.hole_depth_mm > 0 ? options.hole_depth_mm : hole.depth;
    holes_.push_back(hole);
  }
}

double Damage::strongest(const std::vector<Patch>& patches, const Eigen::Vector3d& p) {
  double most = 0;
  for (const Patch& patch : patches) {
    const double away = (p - patch.centre).norm() / patch.radius;
    if (away < 1.3) {
      const double edge = away + 0.3 * value_noise(p, 0.5 * patch.radius, 77);
      most = std::max(most, patch.strength * std::clamp(2.5 * (1.0 - edge), 0.0, 1.0));
    }
  }
  return most;
}

double Damage::dirt_level_mm(const Eigen::Vector3d& p) const {
  const double dirt = strongest(dirty_, p);
  if (dirt <= 0) {
    return -1e3;
  }
  return -0.75 + 0.55 * dirt + 0.05 * fractal_noise(p, 0.6, 3, seed_ ^ 5);
}

double Damage::crack_mm(const Eigen::Vector3d& p) const {
  double deepest = 0;
  for (const Crack& crack : cracks_) {
    const double away2 = (p - crack.centre).squaredNorm() / (crack.length * crack.length);
    if (away2 >= 1) {
      continue;
    }
    const double taper = 1.0 - away2;
    const double wobble = 0.12 * crack.length * fractal_noise(p, 0.5 * crack.length, 4, crack.seed);
    const double off =
        std::abs(crack.across.dot(p - crack.centre) + wobble) / (0.5 * crack.width * taper + 1e-9);
    if (off < 1) {
      deepest = std::max(deepest, crack.depth * taper * (1.0 - off));
    }
  }
  return deepest;
}

double Damage::hole_mm(const Eigen::Vector3d& p) const {
  double deepest = 0;
  for (const Hole& hole : holes_) {
    const Eigen::Vector3d from = p - hole.centre;
    const double along = hole.axis.dot(from);
    const double away = (from - along * hole.axis).norm();
    if (std::abs(along) < 2.0 && away < hole.radius) {
      deepest = std::max(deepest, hole.depth * std::min(1.0, (hole.radius - away) / wall_mm_));
    }
  }
  return deepest;
}

double Damage::face_along(const Break& broken, const Eigen::Vector3d& p, double along) {
  // Far from the face its roughness does not matter: most points are told apart without noise.
  if (along < broken.offset - 2.0 * broken.rough_mm) {
    return broken.offset + 2.0 * broken.rough_mm;
  }
  // Roughness is taken where the ray from the centre meets the flat face, which keeps the face single-valued.
  const Eigen::Vector3d flat = p * (broken.offset / along);
  return broken.offset + broken.rough_mm * fractal_noise(flat, 6.0, 5, broken.seed) +
         0.06 * fractal_noise(flat, 0.6, 2, broken.seed ^ 3);
}

double Damage::broken_off_mm(const Eigen::Vector3d& p) const {
  double most = 0;
  for (const Break& broken : breaks_) {
    const double along = broken.normal.dot(p);
    most = std::max(most, along - face_along(broken, p, along));
  }
  return most;
}

bool Damage::fracture(Eigen::Vector3d* p) const {
  bool moved = false;
  for (const Break& broken : breaks_) {
    const double along = broken.normal.dot(*p);
    const double face = face_along(broken, *p, along);
    if (along > face) {
      // The body is star-shaped: points drawn along their own rays to the centre never cross.
      *p *= face / along;
      moved = true;
    }
  }
  return moved;
}

}  // namespace dubsar::sim
