// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/earlier_package.h"

#include <algorithm>

#include "formats/atomic_file.h"
#include "formats/bag_check.h"
#include "formats/json_node.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

/// A scan is stored once and never changes: its grid tells which session it is.
bool is_grid(const StampedFile& file) {
  return fs::path(file.name).extension() == ".grid";
}

}  // namespace

Result<bool> is_earlier_package(const fs::path& package, const StampedWork& now, JobContext& job) {
  std::error_code error;
  if (!fs::is_regular_file(now.stamp(), error) || !is_bag(package)) {
    return false;
  }
  const Result<std::string> text = read_whole_file(now.stamp(), kMaxJsonBytes);
  const Result<DoneStamp> known =
      text ? parse_done_stamp(*text, now.stamp().string()) : std::unexpected(text.error());
  if (!known || known->verb != "export" || std::ranges::none_of(known->inputs, is_grid) ||
      !std::ranges::all_of(known->inputs, [&](const StampedFile& file) {
        return !is_grid(file) || std::ranges::find(now.inputs(), file) != now.inputs().end();
      })) {
    return false;
  }
  // Not by the stamp's outputs: an export that was killed at its very end leaves the stamp of the package
  // that did not come, beside the one that is still there.
  const Result<BagReport> report = check_bag(package, job);
  if (!report) {
    return std::unexpected(report.error());
  }
  return report->ok();
}

}  // namespace dubsar
