// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/device_uri.h"
#include "acquisition/grid_builder.h"
#include "acquisition/resample.h"
#include "core/job.h"
#include "core/range_grid.h"
#include "core/result.h"
#include "core/rig.h"
#include "drivers/device.h"

namespace dubsar {

/// How a scan came in, besides its grid.
struct ScanRecord {
  ScanTally tally;  ///< as the driver counted
  ProfileFaults faults;
  bool resampled = false;              ///< the device gave points without an order
  std::vector<std::string> remarks{};  ///< of the driver, for the operator; one line each
  std::string file{};                  ///< that a recorded scan was read from, with its folders; else empty
};

/// What of a scan was lost or came wrong, for the operator, in one line; empty where nothing was.
[[nodiscard]] std::string losses_of(const ScanRecord& record);

/// A device opened by its URI, as a source of range grids. Use from one thread at a time.
class RangeSource {
 public:
  /// Called on the scanning thread after each row that was appended: `grid` is complete up to row `row`, its
  /// last, and grows with the next. Rows that were lost before it are there, empty, without a call of their
  /// own. A slow observer holds up the device.
  using RowObserver = std::function<void(const RangeGrid& grid, int row)>;

  [[nodiscard]] static Result<RangeSource> open(std::string_view uri, const DriverRegistry& registry,
                                                const ResampleOptions& resampling = {});

  [[nodiscard]] const DeviceUri& uri() const { return uri_; }
  [[nodiscard]] const DeviceCapabilities& capabilities() const { return capabilities_; }
  [[nodiscard]] Device& device() { return device_; }

  /// Asks for where the next scan is taken from. When the job is cancelled meanwhile the device is stopped,
  /// where it offers that, and the answer is kCancelled, or unstopped(); a job that is halted halts this, for
  /// good.
  Status place(const Placement& placement, JobContext& job);
  /// Stops all motion, where the device offers that; else unstopped().
  Status stop();
  /// kDevice, with what to do by hand: the device did not obey when it was told to stop last.
  [[nodiscard]] std::optional<Error> unstopped() const;
  /// The emergency stop, from any thread: within some milliseconds of this a scan or a placement that runs
  /// has been told to end at once, lasers off, whatever that does to the stage's position. What was scanned
  /// is in partial(), and the answer, now and to all that is asked later, is the error of halted(): which of
  /// the two it is the device has said.
  void halt() const { *halted_ = true; }
  /// Whether it was pressed, for what else uses the device() meanwhile; lives as long as this.
  [[nodiscard]] const std::atomic<bool>* halt_flag() const { return halted_.get(); }
  [[nodiscard]] std::optional<Error> halted() const;

  /// Runs the next scan. Nothing: the source is exhausted. On an error (kDevice, kBadInput, kCancelled when
  /// `job` was cancelled and the device has obeyed) the rows that came are in partial(); a finite source goes
  /// on with its next scan at the next call. Points without an order are resampled first and then handed on
  /// row by row.
  [[nodiscard]] Result<std::optional<RangeGrid>> next(const RowObserver& observer, JobContext& job);

  /// The rows of the last scan when next() failed in the middle of it; moved out.
  [[nodiscard]] std::optional<RangeGrid> take_partial() { return std::exchange(partial_, std::nullopt); }
  /// About the last scan; its remarks are there as soon as the driver made them.
  [[nodiscard]] const ScanRecord& record() const { return record_; }

 private:
  RangeSource(DeviceUri uri, Device device, DeviceCapabilities capabilities, ResampleOptions resampling);
  /// Why nothing is asked of the device any more, once it was told to stop.
  [[nodiscard]] std::optional<Error> halted_before(const JobContext& job);
  [[nodiscard]] std::optional<Error> ended_by_hand(const JobContext& job) const;
  /// One call of the device, which is stopped when it is to be.
  template <class Call>
  [[nodiscard]] auto watched(const JobContext& job, const Call& call);
  void note_stop(const Status& answer);

  DeviceUri uri_;
  Device device_;
  DeviceCapabilities capabilities_;
  ResampleOptions resampling_;
  std::unique_ptr<std::atomic<bool>> halted_ = std::make_unique<std::atomic<bool>>(false);
  std::optional<Error> stop_refused_;  ///< what the device answered when it was stopped last
  std::optional<RangeGrid> partial_;
  ScanRecord record_;
};

}  // namespace dubsar
