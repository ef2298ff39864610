// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/device_patience.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <optional>
#include <string>

#include "drivers/driver_call.h"

namespace dubsar {
namespace {

TEST(DevicePatience, ADeviceThatComesBackIsToldOfNoMore) {
  std::promise<std::string> silent;
  std::promise<void> answers;
  std::atomic<bool> given_up = false;
  std::optional<DriverCall> call(std::in_place, "slow:1");
  const DevicePatience patience([] { return true; },
                                [&](const Error& error) { silent.set_value(error.where); },
                                [&](const Error&) { given_up = true; }, [&] { answers.set_value(); });
  EXPECT_EQ(silent.get_future().get(), "slow:1");
  call.reset();
  answers.get_future().wait();
  EXPECT_FALSE(given_up);
}

}  // namespace
}  // namespace dubsar
