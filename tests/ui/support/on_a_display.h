// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tests/support/temporary_folder.h"
#include "tests/ui/support/display.h"

namespace dubsar::test {

/// A test of commands that open a window, on a display of its own and with a folder of its own; fails where
/// there is no Xvfb.
class OnADisplay : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(display_.works()) << "there is no Xvfb here: install xvfb (packages.txt)";
  }
  [[nodiscard]] std::string in(const std::string& name) const { return (folder_.path() / name).string(); }

  TemporaryFolder folder_;
  Display display_;
};

}  // namespace dubsar::test
