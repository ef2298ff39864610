// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"

namespace dubsar::v4l2 {

/// One way in which a camera can send frames.
struct Mode {
  std::uint32_t fourcc = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  double rate_hz = 0;  ///< the fastest; 0 when the camera does not say

  bool operator==(const Mode&) const = default;
};

/// How a format becomes mono pixels, from the best to the worst for measuring a stripe.
enum class Handling {
  kMono,        ///< as it is: one or two bytes a pixel
  kLumaPlane,   ///< planar YUV: its first plane, as it is
  kPackedLuma,  ///< YUYV or UYVY: every second byte
  kConverted,   ///< Bayer, RGB or rarer: through libv4l2 to planar YUV
  kCompressed,  ///< motion JPEG: the luma of each picture is unpacked
};

struct FormatUse {
  Handling handling = Handling::kConverted;
  std::uint32_t pixel_format = 0;     ///< dubsar_pixel_format
  std::uint32_t bytes_per_pixel = 1;  ///< of the plane that is used
  std::uint32_t luma_at = 0;          ///< of kPackedLuma: the first luma byte
};

[[nodiscard]] FormatUse use_of(std::uint32_t fourcc);

/// Whether the luma of this format has the range of television, from 16 to 235. `quantization`: what the
/// camera says of it. Of YUV it has to say so: most that say nothing send all values. What libv4l2 makes of
/// RGB and Bayer pixels always has that range.
[[nodiscard]] bool has_limited_range(std::uint32_t fourcc, std::uint32_t quantization);
/// Such luma from 0 to 255, in place: what is saturated reads so.
void expand_range(std::span<std::uint8_t> luma);

/// "GREY", "Y16 ", ...; and back, short words filled with blanks.
[[nodiscard]] std::string name_of(std::uint32_t fourcc);
[[nodiscard]] std::optional<std::uint32_t> fourcc_from(const std::string& name);

/// What the operator asked for; what is absent is chosen.
struct Wish {
  std::optional<std::uint32_t> fourcc = {};
  std::optional<std::pair<std::uint32_t, std::uint32_t>> size = {};
  std::optional<double> rate_hz = {};
};

/// The best mode that fulfils the wish: uncompressed mono before planes of luma before packed luma before
/// what must be converted before what is compressed, then the most pixels, the highest rate, and eight bits
/// before more. kUsage with what there is when none fulfils it, kBadInput when the camera offers nothing at
/// all.
[[nodiscard]] Result<Mode> choose(std::span<const Mode> modes, const Wish& wish, const std::string& where);

}  // namespace dubsar::v4l2
