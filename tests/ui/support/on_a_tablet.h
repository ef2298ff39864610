// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"
#include "tests/ui/support/on_a_display.h"

namespace dubsar::test {

/// A test that looks at a small tablet and its wedges through the real window; fails where there is no Xvfb.
/// The tablet is made once; each test of a suite has a copy.
class OnATablet : public OnADisplay {
 protected:
  static void SetUpTestSuite() {
    made_ = new TemporaryFolder;
    const std::string tablet = (made_->path() / "tablet.ply").string();
    run_command({"simulate", "tablet", "--seed", "3", "--size", "16x14x8", "--spacing", "0.1", "-o",
                 made_->path().string()});
    analysed_ =
        run_command({"analyze", tablet, "-o", (made_->path() / "tablet.wedges.json").string()}).status;
  }
  static void TearDownTestSuite() { delete made_; }
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(OnADisplay::SetUp());
    ASSERT_EQ(analysed_, 0);
    std::filesystem::copy(made_->path(), folder_.path(), std::filesystem::copy_options::recursive);
  }
  /// In the folder, where what is kept of a mesh goes.
  [[nodiscard]] Outcome play(const std::string& script) const {
    std::ofstream(folder_.path() / "a.script") << script;
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(folder_.path());
    auto outcome = run_command({"station", "--mesh", "tablet.ply", "--script", "a.script"});
    std::filesystem::current_path(before);
    return outcome;
  }

  inline static TemporaryFolder* made_ = nullptr;
  inline static int analysed_ = -1;
};

}  // namespace dubsar::test
