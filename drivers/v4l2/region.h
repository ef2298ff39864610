// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <optional>

#include "core/result.h"
#include "drivers/v4l2/node.h"

namespace dubsar::v4l2 {

/// A part of the picture that a camera sends by itself, in pixels from its corner.
struct Region {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;

  bool operator==(const Region&) const = default;
};

/// Puts the camera back to its whole picture, which the program before may have left cut, and says how large
/// that is. Nothing where it cannot be asked for a part, as hardly any webcam can.
[[nodiscard]] std::optional<Region> whole_picture(const Node& node);
/// kUsage where the camera makes another one of it; kDevice where it refuses. Sizes of frames are settled
/// afterwards.
Status put_region(const Node& node, const Region& region);
/// The part that is sent now; nothing as of whole_picture().
[[nodiscard]] std::optional<Region> region_now(const Node& node);

}  // namespace dubsar::v4l2
