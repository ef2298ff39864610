// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

struct dubsar_device;
struct dubsar_driver;

namespace dubsar {

/// What a camera's pixels are: one byte each, or two in the byte order of this machine, value in the low
/// bits.
enum class PixelFormat { kMono8, kMono10, kMono12, kMono14, kMono16 };

[[nodiscard]] constexpr std::uint32_t bytes_per_pixel(PixelFormat format) {
  return format == PixelFormat::kMono8 ? 1 : 2;
}
/// The greatest value that a pixel can have: what counts as saturated.
[[nodiscard]] constexpr std::uint32_t full_scale(PixelFormat format) {
  constexpr std::uint32_t kScales[] = {255, 1023, 4095, 16383, 65535};
  return kScales[static_cast<int>(format)];
}

/// A place in a driver's pool; gives it back when it goes, from any thread. Keeps the device open.
class FrameLease {
 public:
  FrameLease() = default;
  FrameLease(const dubsar_driver* driver, std::shared_ptr<dubsar_device> device, std::uint64_t lease)
      : driver_(driver), device_(std::move(device)), lease_(lease) {}
  FrameLease(FrameLease&& other) noexcept = default;
  FrameLease& operator=(FrameLease&& other) noexcept;
  ~FrameLease() { give_back(); }

 private:
  void give_back() noexcept;
  const dubsar_driver* driver_ = nullptr;
  std::shared_ptr<dubsar_device> device_;
  std::uint64_t lease_ = 0;
};

/// One frame of a camera. The pixels live as long as this does; hold few, for the pool is of fixed size.
struct Frame {
  FrameLease lease;
  std::int64_t id = 0;            ///< ascending; a gap is frames that were lost
  std::int64_t timestamp_ns = 0;  ///< this machine's CLOCK_MONOTONIC
  bool exposed = false;           ///< timestamp_ns is of the exposure; else of the arrival
  std::int64_t device_timestamp_ns = 0;
  std::optional<std::int64_t> encoder;
  bool incomplete = false;  ///< a part of the pixels never came
  bool late = false;        ///< waited longer than a frame takes
  PixelFormat format = PixelFormat::kMono8;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t stride_bytes = 0;
  std::uint32_t offset_x = 0;  ///< of the region on the sensor, pixels
  std::uint32_t offset_y = 0;
  std::span<const std::uint8_t> pixels;  ///< height rows of stride_bytes
};

/// Since the device was opened.
struct FrameCounters {
  std::uint32_t pool = 0;
  std::uint64_t delivered = 0;
  std::uint64_t lost = 0;
  std::uint64_t late = 0;
  std::uint64_t incomplete = 0;
  std::uint64_t resent = 0;
  std::uint64_t reconnections = 0;
  std::uint64_t starved = 0;  ///< of those lost: for want of a free buffer, as far as the driver can tell
};

}  // namespace dubsar
