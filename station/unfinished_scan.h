// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "core/range_grid.h"
#include "core/result.h"
#include "core/rig.h"

namespace dubsar {

/// The rows of a scan under way, on disk while the others still come: nobody may touch the tablet twice
/// because a program was killed or a battery was empty. They are gone once the scan is stored, or was ended
/// on purpose. A session keeps them in grids/unfinished/N/, as grid files of some rows each.
class UnfinishedScan {
 public:
  /// Nothing is written before the scan has taken `every`, nor more often than that.
  UnfinishedScan(const std::filesystem::path& session, std::optional<Placement> drive,
                 std::chrono::milliseconds every = std::chrono::seconds(1));
  /// Takes the rows away, unless they were left.
  ~UnfinishedScan();
  UnfinishedScan(const UnfinishedScan&) = delete;
  UnfinishedScan& operator=(const UnfinishedScan&) = delete;

  /// Copies what has come since the last time; a thread of its own writes it. From the scanning thread: rows
  /// that have come do not change any more. A disk that refuses ends it with one warning, and not the scan.
  void follow(const RangeGrid& grid, int placement_offset);
  /// What the device has remarked on it until now; written with the rows, or after them. From the scanning
  /// thread.
  void remark(const std::string& text);
  /// The scan could not be stored: its rows stay for the next program.
  void leave() { left_ = true; }

 private:
  void write_rows(const std::stop_token& stop, std::error_code making);

  const std::filesystem::path folder_;
  const std::optional<Placement> drive_;
  const std::chrono::milliseconds every_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  int copied_rows_ = 0;
  std::atomic<bool> left_ = false;
  std::atomic<bool> refused_ = false;
  std::mutex mutex_;  ///< of what follows
  std::condition_variable_any comes_;
  std::optional<RangeGrid> to_write_;
  std::string remark_;
  std::jthread writer_;
};

/// A scan whose program ended in the middle of it.
struct LeftScan {
  /// The rows that can be read, in order. Within a part none is missing; how many are between two, nobody
  /// knows.
  std::vector<RangeGrid> parts;
  std::optional<Placement> drive;
  std::string remark;  ///< of the device on it; empty where there was none
  std::filesystem::path folder;
  std::vector<Error> unread;  ///< an error for each of its files that is missing or cannot be read

  [[nodiscard]] int rows() const;  ///< of the parts that have a sample
};

/// By age. For a session that this program alone writes to.
[[nodiscard]] std::vector<LeftScan> left_scans(const std::filesystem::path& session);
/// Whether the one has the other's rows, and perhaps more above or below them.
[[nodiscard]] bool holds(const RangeGrid& grid, const RangeGrid& rows);
/// Once all its rows are stored as a scan.
void forget(const LeftScan& scan);
/// Once those that can be read are: whatever else its files hold stays, under a name at which nobody looks
/// for a scan to go on with. Returns that folder. Errors: kStorage.
[[nodiscard]] Result<std::filesystem::path> set_aside(const LeftScan& scan);

}  // namespace dubsar
