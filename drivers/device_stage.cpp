// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The stage side of an open device.
#include <cmath>

#include "drivers/abi.h"
#include "drivers/device.h"
#include "drivers/driver.h"
#include "drivers/driver_call.h"

namespace dubsar {

namespace {

std::unexpected<Error> no_stage(const std::string& where) {
  return fail(ErrorKind::kUsage, "this device is no stage", where, "name a stage");
}

struct AxisCollector {
  std::vector<StageAxis> axes;
  std::optional<Error> refused;
  const std::string& where;
};

}  // namespace

Result<std::vector<StageAxis>> Device::axes() const {
  const auto describe = abi::offered(driver_, &dubsar_driver::describe_axes);
  if (describe == nullptr) {
    return no_stage(uri_);
  }
  AxisCollector collected{{}, {}, uri_};
  const auto collect = [](void* user, const dubsar_axis* axis) noexcept -> std::int32_t {
    auto& to = *static_cast<AxisCollector*>(user);
    Result<StageAxis> taken = abi::axis_from(abi::taken(axis), to.where);
    if (!taken) {
      to.refused = taken.error();
      return 1;
    }
    to.axes.push_back(std::move(*taken));
    return 0;
  };
  const DriverCall call(uri_);
  auto error = abi::lent<dubsar_error>();
  const std::int32_t code = describe(device_.get(), collect, &collected, &error);
  if (collected.refused) {
    return std::unexpected(*collected.refused);
  }
  if (code != DUBSAR_OK) {
    return std::unexpected(abi::error_from(code, error, uri_));
  }
  return std::move(collected.axes);
}

Status Device::home() {
  const auto home = abi::offered(driver_, &dubsar_driver::home);
  if (home == nullptr) {
    return no_stage(uri_);
  }
  const DriverCall call(uri_);
  auto error = abi::lent<dubsar_error>();
  const std::int32_t code = home(device_.get(), &error);
  return abi::status_from(code, error, uri_);
}

Status Device::move(const StageMove& asked) {
  const auto move = abi::offered(driver_, &dubsar_driver::move);
  if (move == nullptr) {
    return no_stage(uri_);
  }
  if (!std::isfinite(asked.position) || !std::isfinite(asked.speed) || asked.speed < 0) {
    return fail(ErrorKind::kUsage, "a move to no position or at no speed", uri_);
  }
  const DriverCall call(uri_);
  auto passed = abi::lent<dubsar_move>();
  passed.flags = asked.start_only ? DUBSAR_MOVE_START_ONLY : 0U;
  passed.axis = asked.axis;
  passed.position = asked.position;
  passed.speed = asked.speed;
  auto error = abi::lent<dubsar_error>();
  const std::int32_t code = move(device_.get(), &passed, &error);
  return abi::status_from(code, error, uri_);
}

Result<StageReading> Device::motion() const {
  const auto read = abi::offered(driver_, &dubsar_driver::read_motion);
  if (read == nullptr) {
    return no_stage(uri_);
  }
  const DriverCall call(uri_);
  auto lent = abi::lent<dubsar_motion>();
  auto error = abi::lent<dubsar_error>();
  if (const std::int32_t code = read(device_.get(), &lent, &error); code != DUBSAR_OK) {
    return std::unexpected(abi::error_from(code, error, uri_));
  }
  return abi::motion_from(lent, uri_);
}

Status Device::set_laser(std::uint32_t laser, double power) {
  const auto set = abi::offered(driver_, &dubsar_driver::set_laser);
  if (set == nullptr) {
    return no_stage(uri_);
  }
  if (!(power >= 0 && power <= 1)) {
    return fail(ErrorKind::kUsage, "laser power is from 0 to 1", uri_);
  }
  const DriverCall call(uri_);
  auto error = abi::lent<dubsar_error>();
  const std::int32_t code = set(device_.get(), laser, power, &error);
  return abi::status_from(code, error, uri_);
}

Status Device::emergency_stop() const {
  const auto halt = abi::offered(driver_, &dubsar_driver::emergency_stop);
  if (halt == nullptr) {
    return no_stage(uri_);
  }
  const DriverCall call(uri_);
  auto error = abi::lent<dubsar_error>();
  const std::int32_t code = halt(device_.get(), &error);
  return abi::status_from(code, error, uri_);
}

}  // namespace dubsar
