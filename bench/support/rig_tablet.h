// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "core/mesh_query.h"
#include "sim/scene.h"
#include "sim/tablet.h"

namespace dubsar {

/// The tablet that the benches of a rig look at, 44 × 36 × 18 mm: blank and smooth, or written, grained and
/// sealed. It does not move: its parts know each other.
struct RigTablet {
  explicit RigTablet(sim::SimTablet made) : tablet(std::move(made)), query(tablet.mesh) {
    scene.tablet = &tablet;
    scene.query = &query;
    for (const Eigen::Vector3f& p : tablet.mesh.positions) {
      top_mm = std::max(top_mm, static_cast<double>(p.z()));
    }
  }
  RigTablet(const RigTablet&) = delete;
  RigTablet& operator=(const RigTablet&) = delete;

  sim::SimTablet tablet;
  MeshQuery query;
  sim::Scene scene;
  double top_mm = 0;  ///< the highest point of the obverse
};

[[nodiscard]] inline Result<std::unique_ptr<RigTablet>> rig_tablet(
    bool written, std::optional<std::uint64_t> seed = std::nullopt) {
  sim::TabletOptions wanted;
  wanted.seed = seed.value_or(wanted.seed);
  wanted.size_mm = {44, 36, 18};
  wanted.text_density = written ? 1.0 : 0.0;
  wanted.grain_um = written ? 12 : 0;
  wanted.seal_um = written ? 20 : 0;
  wanted.damage = sim::DamageOptions::none();
  JobContext job;
  Result<sim::SimTablet> made = sim::make_tablet(wanted, job);
  return made ? Result<std::unique_ptr<RigTablet>>(std::make_unique<RigTablet>(std::move(*made)))
              : std::unexpected(made.error());
}

}  // namespace dubsar
