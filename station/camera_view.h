// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/exposure.h"
#include "drivers/frame.h"

namespace dubsar {

/// A frame of the camera for a person to look at: thinned, with what its exposure says of each pixel.
struct CameraView {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> grey;  ///< [width*height]
  std::vector<PixelMark> mark;     ///< [width*height]; of any pixel that fell into it, saturated before dark
  Exposure exposure;               ///< of the whole frame
  std::shared_ptr<const GrayImage> image;  ///< the whole frame
  std::string camera_serial;               ///< empty when not known
  std::optional<bool> lit;                 ///< of a rig: its laser was on; of a camera alone nobody knows
};

/// Sides of at most `most_px`. Two bytes per pixel become one.
[[nodiscard]] CameraView camera_view_of(const Frame& frame, int most_px = 720);

}  // namespace dubsar
