// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/conf_unit.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/scan_pose.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

TEST(ConfUnit, IsTheOneThatAScanStatesBehindAByteOrderMark) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a.ply";
  std::ofstream(file) << "\xEF\xBB\xBF"
                      << "ply\nformat ascii 1.0\nobj_info unit m\nelement vertex 1\nproperty float x\n"
                         "property float y\nproperty float z\nend_header\n0 0 0.1\n";
  ScanPose pose;
  pose.file = file.filename().string();
  EXPECT_EQ(mm_per_unit_of_scans(file, {pose}).value(), 1000.0);
}

}  // namespace
}  // namespace dubsar
