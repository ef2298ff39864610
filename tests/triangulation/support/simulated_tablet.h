// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>

#include "core/job.h"
#include "core/mesh_query.h"
#include "sim/scene.h"
#include "sim/tablet.h"

namespace dubsar::test {

/// A small, coarse tablet of the simulator (0.15 mm), for a scanner to look at.
class SimulatedTablet {
 public:
  explicit SimulatedTablet(const Eigen::Vector3d& size_mm) : tablet_(make(size_mm)), truth_(tablet_.mesh) {
    scene_.tablet = &tablet_;
    scene_.query = &truth_;
  }
  SimulatedTablet(const SimulatedTablet&) = delete;
  SimulatedTablet& operator=(const SimulatedTablet&) = delete;

  [[nodiscard]] const sim::Scene& scene() const { return scene_; }
  [[nodiscard]] const MeshQuery& truth() const { return truth_; }
  [[nodiscard]] const Mesh& mesh() const { return tablet_.mesh; }

 private:
  static sim::SimTablet make(const Eigen::Vector3d& size_mm) {
    sim::TabletOptions options;
    options.size_mm = size_mm;
    options.spacing_mm = 0.15;
    JobContext job;
    return sim::make_tablet(options, job).value();
  }

  sim::SimTablet tablet_;
  MeshQuery truth_;
  sim::Scene scene_;
};

}  // namespace dubsar::test
