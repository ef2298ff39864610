// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/v4l2/modes.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <tuple>

#include "core/number_text.h"
#include "drivers/driver.h"

namespace dubsar::v4l2 {

namespace {

/// Cameras count intervals in whole fractions of a second: 29.97 is meant by whoever asks for 30.
constexpr double kRateTolerance = 0.01;

std::string described(const Mode& mode) {
  std::string out =
      name_of(mode.fourcc) + " " + std::to_string(mode.width) + "x" + std::to_string(mode.height);
  if (mode.rate_hz > 0) {
    out += " at " + short_text(mode.rate_hz) + "/s";
  }
  return out;
}

/// A few of the modes, for a line that says what there is.
std::string offered(std::span<const Mode> modes) {
  constexpr std::size_t kMost = 4;
  std::string out;
  for (std::size_t k = 0; k < std::min(modes.size(), kMost); ++k) {
    out += (k == 0 ? "" : ", ") + described(modes[k]);
  }
  return modes.size() > kMost ? out + " and " + std::to_string(modes.size() - kMost) + " more" : out;
}

bool fulfils(const Mode& mode, const Wish& wish) {
  return (!wish.fourcc || *wish.fourcc == mode.fourcc) &&
         (!wish.size || *wish.size == std::pair(mode.width, mode.height)) &&
         (!wish.rate_hz || mode.rate_hz == 0 || mode.rate_hz >= *wish.rate_hz * (1 - kRateTolerance));
}

}  // namespace

FormatUse use_of(std::uint32_t fourcc) {
  switch (fourcc) {
    case V4L2_PIX_FMT_GREY:
      return {Handling::kMono, DUBSAR_PIXEL_MONO8, 1, 0};
    case V4L2_PIX_FMT_Y10:
      return {Handling::kMono, DUBSAR_PIXEL_MONO10, 2, 0};
    case V4L2_PIX_FMT_Y12:
      return {Handling::kMono, DUBSAR_PIXEL_MONO12, 2, 0};
    case V4L2_PIX_FMT_Y14:
      return {Handling::kMono, DUBSAR_PIXEL_MONO14, 2, 0};
    case V4L2_PIX_FMT_Y16:
      return {Handling::kMono, DUBSAR_PIXEL_MONO16, 2, 0};
    case V4L2_PIX_FMT_NV12:
    case V4L2_PIX_FMT_NV21:
    case V4L2_PIX_FMT_NV16:
    case V4L2_PIX_FMT_YUV420:
    case V4L2_PIX_FMT_YVU420:
    case V4L2_PIX_FMT_YUV422P:
      return {Handling::kLumaPlane, DUBSAR_PIXEL_MONO8, 1, 0};
    case V4L2_PIX_FMT_YUYV:
    case V4L2_PIX_FMT_YVYU:
      return {Handling::kPackedLuma, DUBSAR_PIXEL_MONO8, 2, 0};
    case V4L2_PIX_FMT_UYVY:
    case V4L2_PIX_FMT_VYUY:
      return {Handling::kPackedLuma, DUBSAR_PIXEL_MONO8, 2, 1};
    case V4L2_PIX_FMT_MJPEG:
    case V4L2_PIX_FMT_JPEG:
      return {Handling::kCompressed, DUBSAR_PIXEL_MONO8, 1, 0};
    default:
      return {Handling::kConverted, DUBSAR_PIXEL_MONO8, 1, 0};
  }
}

bool has_limited_range(std::uint32_t fourcc, std::uint32_t quantization) {
  switch (use_of(fourcc).handling) {
    case Handling::kLumaPlane:
    case Handling::kPackedLuma:
      return quantization == V4L2_QUANTIZATION_LIM_RANGE;
    case Handling::kConverted:
      return fourcc != V4L2_PIX_FMT_PJPG && fourcc != V4L2_PIX_FMT_JPGL;  // JPEG, whose luma has all values
    case Handling::kMono:
    case Handling::kCompressed:
      break;
  }
  return false;
}

void expand_range(std::span<std::uint8_t> luma) {
  static constexpr std::array<std::uint8_t, 256> kExpanded = [] {
    constexpr int kBlack = 16;
    constexpr int kSteps = 219;
    std::array<std::uint8_t, 256> out{};
    for (int k = 0; k < 256; ++k) {
      const int above = std::clamp(k - kBlack, 0, kSteps);
      out[static_cast<std::size_t>(k)] = static_cast<std::uint8_t>((2 * 255 * above + kSteps) / (2 * kSteps));
    }
    return out;
  }();
  std::ranges::transform(luma, luma.begin(), [](std::uint8_t value) { return kExpanded[value]; });
}

std::string name_of(std::uint32_t fourcc) {
  std::string out;
  for (int k = 0; k < 4; ++k) {
    const char c = static_cast<char>(fourcc >> (8 * k) & 0x7fU);
    out += c >= ' ' && c != 0x7f ? c : '?';
  }
  return out;
}

std::optional<std::uint32_t> fourcc_from(const std::string& name) {
  if (name.empty() || name.size() > 4) {
    return std::nullopt;
  }
  std::uint32_t out = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const char c = k < name.size() ? name[k] : ' ';
    if (c < ' ' || c > '~') {
      return std::nullopt;
    }
    out |= static_cast<std::uint32_t>(c) << (8 * k);
  }
  return out;
}

Result<Mode> choose(std::span<const Mode> modes, const Wish& wish, const std::string& where) {
  std::vector<Mode> fit;
  std::ranges::copy_if(modes, std::back_inserter(fit), [&](const Mode& mode) { return fulfils(mode, wish); });
  if (modes.empty()) {
    return bad_input(where, "the camera offers no format", "see that it is a capture device");
  }
  if (fit.empty()) {
    return fail(ErrorKind::kUsage, "the camera has no such mode", where, "it has " + offered(modes));
  }
  const auto order = [](const Mode& mode) {
    const FormatUse use = use_of(mode.fourcc);
    return std::tuple(use.handling, -std::int64_t{mode.width} * mode.height, -mode.rate_hz,
                      use.bytes_per_pixel, mode.fourcc);
  };
  Mode best = *std::ranges::min_element(fit, {}, order);
  if (wish.rate_hz) {
    best.rate_hz = *wish.rate_hz;
  }
  return best;
}

}  // namespace dubsar::v4l2
