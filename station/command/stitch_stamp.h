// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "core/job.h"
#include "core/result.h"
#include "station/command/left_out_scans.h"
#include "station/done_stamp.h"

namespace dubsar {

/// A session's stitching as `--unless-done` knows it before a grid is read as a grid.
struct StitchStamp {
  /// Nothing where the grids and where the session has them lie do not decide the mesh: with a scan that has
  /// not been judged yet all are registered anew.
  std::optional<StampedWork> work;
  std::vector<LeftOutScan>
      left_out;  ///< as the session's list has it; which scans are copies it does not say
};

/// Errors: those of SessionStore::open() and StampedWork::begin().
[[nodiscard]] Result<StitchStamp> begin_stitch(const std::filesystem::path& session,
                                               const std::filesystem::path& out, const JobContext& job);

}  // namespace dubsar
