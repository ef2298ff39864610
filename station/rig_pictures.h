// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/job.h"
#include "core/result.h"
#include "sim/frame_renderer.h"
#include "sim/frame_rig.h"

namespace dubsar {

struct RigPicturesOptions {
  sim::FrameRigOptions rig;
  sim::FrameOptions optics;
  int poses = 15;
  int stops = 5;  ///< of the stage; none for a galvanometer
  std::uint64_t seed = 1;
  std::string board = "charuco:14x9:4:2.96";
};

/// The pictures that an operator would take to calibrate a rig, rendered: calibration.toml, the pictures it names,
/// and truth.json, the calibration that should come out.
[[nodiscard]] Status write_rig_pictures(const RigPicturesOptions& options, const std::filesystem::path& folder,
                                        const JobContext& job);

}  // namespace dubsar
