// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "formats/grid_reader.h"

namespace dubsar::replay {

/// The scans of a folder or a file in order, read from the disk one file at a time, when it is its turn.
class ScanFiles {
 public:
  /// A folder: the scans in it (look_into_folder()), in name order, not recursed. A file: that one, whatever
  /// it looks like. kBadInput when there is nothing to play.
  [[nodiscard]] static Result<ScanFiles> open(const std::filesystem::path& path,
                                              const GridReadOptions& options);

  /// The next scan; nothing after the last. An error (with its file) is that file's alone: the next call goes
  /// on behind it. But kCancelled, soon after the job was, leaves it to be read.
  [[nodiscard]] Result<std::optional<ScanData>> next(const JobContext& job);

  /// Nothing when some file must be read to know (PTX holds several scans).
  [[nodiscard]] std::optional<std::int64_t> count() const { return count_; }

  /// Which text files of the folder were not taken for scans though they hold points, in one line; empty:
  /// none.
  [[nodiscard]] const std::string& passed_over() const { return passed_over_; }

  /// Which the last scan came from; next() has given one.
  [[nodiscard]] const std::filesystem::path& file() const { return files_[next_file_ - 1]; }

  /// What reading says of a scan of the last file, by the scan's name.
  [[nodiscard]] std::vector<std::string> remarks_on(const std::string& scan) const;

 private:
  ScanFiles(std::vector<std::filesystem::path> files, GridReadOptions options);

  std::vector<std::filesystem::path> files_;
  GridReadOptions options_;
  std::optional<std::int64_t> count_;
  std::string passed_over_;
  std::size_t next_file_ = 0;
  std::deque<ScanData> waiting_;  ///< the other scans of the file that was read last
  std::vector<std::pair<std::string, std::string>> remarks_;  ///< on its scans, by name
};

}  // namespace dubsar::replay
