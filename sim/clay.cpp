// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/clay.h"

#include "sim/noise.h"
#include "sim/script.h"

namespace dubsar::sim {

namespace {

/// Reed and pressure smooth the clay: inside a wedge less of the grain is left.
constexpr double kGrainInWedge = 0.3;

std::vector<Impression> impressions_for(const TabletOptions& options, const TabletBody& body) {
  ScriptOptions script;
  script.seed = options.seed;
  script.density = options.text_density;
  script.line_height_mm = options.line_height_mm;
  script.edges = options.text_on_edges;
  return write_text(body, script);
}

}  // namespace

Clay::Clay(const TabletOptions& options, const TabletBody& body)
    : options_(options),
      impressions_(impressions_for(options, body)),
      index_(impressions_, body.half_size_mm()),
      seal_(body, 0.001 * options.seal_um, options.seed) {}

double Clay::grain_mm(const Eigen::Vector3d& p) const {
  if (options_.grain_um <= 0) {
    return 0;
  }
  return 0.001 * options_.grain_um *
         (1.1 * value_noise(p, 1.7, options_.seed ^ 0x51) +
          0.7 * fractal_noise(p, 0.45, 3, options_.seed ^ 0x52));
}

ClayPoint Clay::at(const Eigen::Vector3d& p, const Eigen::Vector3d& n) const {
  const double grain = grain_mm(p);
  ClayPoint point;
  point.height_mm = grain + seal_.height_mm(p, n);
  point.kind = seal_.covers(p, n) ? SurfaceKind::kSeal : SurfaceKind::kBody;
  for (const std::uint32_t k : index_.near(p)) {
    int face = -1;
    point.height_mm = impressions_[k].press(p, n, point.height_mm, &face);
    if (face < 0) {
      continue;
    }
    point.wedge = static_cast<std::int32_t>(k);
    point.face = face;
    point.hollow_mm = point.height_mm;
    point.kind = SurfaceKind::kWedge;
    const auto slot = static_cast<std::size_t>(point.pressed_count) % point.pressed.size();
    point.pressed[slot] = k;
    ++point.pressed_count;
  }
  if (point.wedge >= 0) {
    point.height_mm += kGrainInWedge * grain;
    point.hollow_mm += kGrainInWedge * grain;
  }
  return point;
}

std::int32_t Clay::depth_point_near(const Eigen::Vector3d& p, double radius_mm) const {
  std::int32_t best = -1;
  double nearest = radius_mm * radius_mm;
  for (const std::uint32_t k : index_.near(p)) {
    const double away = (impressions_[k].foot_mm() - p).squaredNorm();
    if (away < nearest) {
      nearest = away;
      best = static_cast<std::int32_t>(k);
    }
  }
  return best;
}

}  // namespace dubsar::sim
