// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/pins.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "core/units.h"

namespace dubsar::sim {

namespace {

constexpr std::size_t kOcclusionSamples = 12000;
/// An operator takes a pin away when it hides more than a speck: this many of the samples.
constexpr int kHiddenAllowed = 2;

bool reaches_into(const Pin& pin, const Support& support) {
  const double tip = support.normal.dot(pin.tip_mm) - support.offset_mm - pin.tip_radius_mm;
  const double end =
      support.normal.dot(pin.tip_mm + pin.arm_length_mm * pin.arm) - support.offset_mm - pin.arm_radius_mm;
  return tip < 0 || end < 0;
}

bool hides(const Pin& pin, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d way = to - from;
  const double length = way.norm();
  return hit_pin(pin, from, way / length, 0.0, length).has_value();
}

}  // namespace

PinStand::PinStand(const SimTablet& tablet, const MeshQuery& query, const PinOptions& options)
    : options_(options) {
  Eigen::Vector3f half = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& p : tablet.mesh.positions) {
    half = half.cwiseMax(p.cwiseAbs());
  }
  Random random(seed_for(options.seed, 41));
  for (int i = 0; i < options.count; ++i) {
    const double azimuth = 2.0 * kPi * (i + random.uniform(-0.25, 0.25)) / options.count;
    const Eigen::Vector3d aim(std::cos(azimuth) * half.x(), std::sin(azimuth) * half.y(),
                              random.uniform(-0.35, 0.35) * half.z());
    const double far = 4.0 * half.norm();
    const Eigen::Vector3d inwards = -aim.normalized();
    const auto hit =
        query.first_hit((-far * inwards).cast<float>(), inwards.cast<float>(), 0.0F, static_cast<float>(far));
    if (!hit) {
      continue;
    }
    const Eigen::Vector3d clay = -far * inwards + hit->distance_mm * inwards;
    Pin pin;
    pin.label = i + 1;
    pin.tip_radius_mm = 0.5 * options.tip_diameter_mm;
    pin.arm_radius_mm = std::max(1.5, 1.5 * options.tip_diameter_mm);
    const double gap = random.uniform(options.gap_min_mm, options.gap_max_mm) + pin.tip_radius_mm;
    // Outwards and level: an arm that leans over the tablet would hide it.
    const Eigen::Vector3d level(-inwards.x(), -inwards.y(), 0);
    pin.arm = (level.normalized() + Eigen::Vector3d(0, 0, random.uniform(-0.12, 0.12))).normalized();
    pin.tip_mm = clay - gap * inwards;
    // The rim bulges: back off along the arm until the whole ball keeps its distance.
    for (int step = 0; step < 40; ++step) {
      const auto near = query.closest(pin.tip_mm.cast<float>(), static_cast<float>(gap));
      if (!near || near->distance_mm >= options.gap_min_mm + pin.tip_radius_mm) {
        break;
      }
      pin.tip_mm += 0.1 * pin.arm;
    }
    pins_.push_back(pin);
  }
}

std::vector<Pin> PinStand::placed(int placement) const {
  std::vector<Pin> pins = pins_;
  if (placement > 0) {
    Random random(seed_for(seed_for(options_.seed, 42), static_cast<std::uint64_t>(placement)));
    for (Pin& pin : pins) {
      for (int axis = 0; axis < 3; ++axis) {
        pin.tip_mm[axis] += options_.replace_sigma_mm * random.normal();
      }
    }
  }
  return pins;
}

std::vector<Pin> standing_pins(const std::vector<Pin>& pins, const Scene& scene,
                               const TriangulationScanner& scanner,
                               const RigidTransform& tablet_from_scanner) {
  Scene bare = scene;
  bare.pins.clear();
  std::vector<int> hidden(pins.size(), 0);
  const RigidTransform scanner_from_tablet = tablet_from_scanner.inverse();
  const Mesh& mesh = scene.tablet->mesh;
  const std::size_t stride = std::max<std::size_t>(1, mesh.positions.size() / kOcclusionSamples);
  for (std::size_t i = 0; i < mesh.positions.size(); i += stride) {
    const Eigen::Vector3d p = mesh.positions[i].cast<double>();
    const double y = (scanner_from_tablet * p).y();
    const ScannerOptions& options = scanner.options();
    const Eigen::Vector3d laser = tablet_from_scanner * Eigen::Vector3d(0, y, options.standoff_mm);
    const Eigen::Vector3d camera =
        tablet_from_scanner * Eigen::Vector3d(0, y + options.baseline_mm, options.standoff_mm);
    const Eigen::Vector3d n = mesh.normals[i].cast<double>();
    if (n.dot(laser - p) <= 0 || n.dot(camera - p) <= 0) {
      continue;
    }
    bool seen_known = false;
    bool seen = false;
    for (std::size_t k = 0; k < pins.size(); ++k) {
      if (!hides(pins[k], p, laser) && !hides(pins[k], p, camera)) {
        continue;
      }
      if (!seen_known) {
        seen = !blocked(bare, p, laser, 0.05) && !blocked(bare, p, camera, 0.05);
        seen_known = true;
      }
      hidden[k] += seen ? 1 : 0;
    }
  }
  std::vector<Pin> standing;
  for (std::size_t k = 0; k < pins.size(); ++k) {
    if (hidden[k] <= kHiddenAllowed && !(scene.support && reaches_into(pins[k], *scene.support))) {
      standing.push_back(pins[k]);
    }
  }
  return standing;
}

std::vector<PinTip> tips_in_scanner(const std::vector<Pin>& pins, const RigidTransform& tablet_from_scanner) {
  const RigidTransform scanner_from_tablet = tablet_from_scanner.inverse();
  std::vector<PinTip> tips;
  tips.reserve(pins.size());
  for (const Pin& pin : pins) {
    tips.push_back({pin.label, scanner_from_tablet * pin.tip_mm});
  }
  return tips;
}

std::vector<PinTip> clicked_tips(const std::vector<PinTip>& true_tips, double max_error_mm,
                                 std::uint64_t seed) {
  std::vector<PinTip> clicked = true_tips;
  Random random(seed_for(seed, 43));
  for (PinTip& tip : clicked) {
    Eigen::Vector3d error = random.normal3();
    error *= 0.4 * max_error_mm;
    if (error.norm() > max_error_mm) {
      error *= max_error_mm / error.norm();
    }
    tip.position_mm += error;
  }
  return clicked;
}

}  // namespace dubsar::sim
