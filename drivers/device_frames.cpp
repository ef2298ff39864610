// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The camera side of an open device.
#include <algorithm>
#include <limits>

#include "drivers/abi.h"
#include "drivers/device.h"
#include "drivers/driver.h"
#include "drivers/driver_call.h"

namespace dubsar {

namespace {

std::unexpected<Error> no_camera(const std::string& where) {
  return fail(ErrorKind::kUsage, "this device yields no frames", where, "name a camera");
}

}  // namespace

FrameLease& FrameLease::operator=(FrameLease&& other) noexcept {
  if (this != &other) {
    give_back();
    driver_ = other.driver_;
    device_ = std::move(other.device_);
    lease_ = other.lease_;
  }
  return *this;
}

void FrameLease::give_back() noexcept {
  if (device_) {
    const DriverCall call(driver_->scheme);
    driver_->release_frame(device_.get(), lease_);
    device_.reset();
  }
}

Status Device::start_frames(std::uint32_t pool) {
  const auto start = abi::offered(driver_, &dubsar_driver::start_frames);
  if (start == nullptr) {
    return no_camera(uri_);
  }
  const DriverCall call(uri_);
  auto error = abi::lent<dubsar_error>();
  const std::int32_t code = start(device_.get(), pool, &error);
  return abi::status_from(code, error, uri_);
}

Result<std::optional<Frame>> Device::next_frame(std::chrono::milliseconds timeout) {
  const auto next = abi::offered(driver_, &dubsar_driver::next_frame);
  if (next == nullptr) {
    return no_camera(uri_);
  }
  const DriverCall call(uri_);
  auto lent = abi::lent<dubsar_frame>();
  auto error = abi::lent<dubsar_error>();
  const auto wait = std::clamp<std::int64_t>(timeout.count(), 0, std::numeric_limits<std::int32_t>::max());
  const std::int32_t code = next(device_.get(), static_cast<std::uint32_t>(wait), &lent, &error);
  if (code == DUBSAR_TIMEOUT) {
    return std::optional<Frame>{};
  }
  if (code != DUBSAR_OK) {
    return std::unexpected(abi::error_from(code, error, uri_));
  }
  FrameLease lease(driver_, device_, lent.lease);  // given back also when the frame is refused
  Result<Frame> frame = abi::frame_from(lent, uri_);
  if (!frame) {
    return std::unexpected(frame.error());
  }
  frame->lease = std::move(lease);
  return std::optional(std::move(*frame));
}

Status Device::stop_frames() {
  const auto stop = abi::offered(driver_, &dubsar_driver::stop_frames);
  if (stop == nullptr) {
    return no_camera(uri_);
  }
  const DriverCall call(uri_);
  auto error = abi::lent<dubsar_error>();
  const std::int32_t code = stop(device_.get(), &error);
  return abi::status_from(code, error, uri_);
}

Result<FrameCounters> Device::frame_counters() const {
  const auto count = abi::offered(driver_, &dubsar_driver::frame_counters);
  if (count == nullptr) {
    return no_camera(uri_);
  }
  const DriverCall call(uri_);
  auto lent = abi::lent<dubsar_frame_counters>();
  auto error = abi::lent<dubsar_error>();
  if (const std::int32_t code = count(device_.get(), &lent, &error); code != DUBSAR_OK) {
    return std::unexpected(abi::error_from(code, error, uri_));
  }
  return FrameCounters{lent.pool,       lent.delivered, lent.lost,          lent.late,
                       lent.incomplete, lent.resent,    lent.reconnections, lent.starved};
}

Status Device::trigger_frame() {
  const auto trigger = abi::offered(driver_, &dubsar_driver::trigger_frame);
  if (trigger == nullptr) {
    return fail(ErrorKind::kUsage, "this device takes no software trigger", uri_, "let it run freely");
  }
  const DriverCall call(uri_);
  auto error = abi::lent<dubsar_error>();
  const std::int32_t code = trigger(device_.get(), &error);
  return abi::status_from(code, error, uri_);
}

}  // namespace dubsar
