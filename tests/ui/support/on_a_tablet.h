// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"
#include "tests/ui/support/display.h"

namespace dubsar::test {

/// A test that looks at a small tablet and its wedges through the real window; fails where there is no Xvfb.
class OnATablet : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!display_.works()) {
      FAIL() << "there is no Xvfb here: install xvfb (packages.txt)";
    }
    ASSERT_EQ(run_command({"simulate", "tablet", "--seed", "3", "--size", "16x14x8", "--spacing", "0.1", "-o",
                           folder_.path().string()})
                  .status,
              0);
    ASSERT_EQ(run_command({"analyze", in("tablet.ply"), "-o", in("tablet.wedges.json")}).status, 0);
  }
  [[nodiscard]] std::string in(const std::string& name) const { return (folder_.path() / name).string(); }
  /// In the folder, where what is kept of a mesh goes.
  [[nodiscard]] Outcome play(const std::string& script) const {
    std::ofstream(folder_.path() / "a.script") << script;
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(folder_.path());
    auto outcome = run_command({"station", "--mesh", "tablet.ply", "--script", "a.script"});
    std::filesystem::current_path(before);
    return outcome;
  }

  Display display_;
  TemporaryFolder folder_;
};

}  // namespace dubsar::test
