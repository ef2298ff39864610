// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <future>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "station/engine.h"
#include "tests/support/temporary_folder.h"

namespace dubsar::test {

/// Runs an engine on scans that come slowly, and lets the test wait for what it says.
class RunningEngine {
 public:
  RunningEngine(const std::filesystem::path& scans, const std::filesystem::path& session, double rate)
      : RunningEngine({"replay:" + scans.string() + "?rate=" + std::to_string(rate), session, false, 0,
                       std::nullopt}) {}
  explicit RunningEngine(EngineOptions options)
      : engine_(std::move(options), [this](const Event& event) { hear(event); }),
        thread_([this] { result_.emplace(engine_.run(job_)); }) {}
  ~RunningEngine() {
    job_.cancel();  // where a test has failed in its middle it may wait for somebody
    join();
  }
  RunningEngine(const RunningEngine&) = delete;
  RunningEngine& operator=(const RunningEngine&) = delete;

  bool post(OperatorCommand command) { return engine_.post(std::move(command)); }
  /// Waits until something said holds the text.
  [[nodiscard]] bool says(const std::string& text) {
    std::unique_lock lock(mutex_);
    return heard_.wait_for(lock, std::chrono::seconds(30),
                           [&] { return said_.find(text) != std::string::npos; });
  }
  const Result<EngineResult>& join() {
    if (thread_.joinable()) {
      thread_.join();
    }
    return *result_;
  }
  [[nodiscard]] std::string said() {
    const std::scoped_lock lock(mutex_);
    return said_;
  }
  [[nodiscard]] int times_waited() {
    const std::scoped_lock lock(mutex_);
    return waits_;
  }
  /// What it said then that it waits for.
  [[nodiscard]] std::optional<NextView> next() {
    const std::scoped_lock lock(mutex_);
    return next_;
  }
  /// Waits until it has waited for the operator that often.
  [[nodiscard]] bool waits(int times) {
    std::unique_lock lock(mutex_);
    return heard_.wait_for(lock, std::chrono::seconds(30), [&] { return waits_ >= times; });
  }
  /// Waits until it has worked out what is red that often.
  [[nodiscard]] bool plans(int times) {
    std::unique_lock lock(mutex_);
    return heard_.wait_for(lock, std::chrono::seconds(30), [&] { return red_maps_ >= times; });
  }
  [[nodiscard]] std::vector<ScanPose> poses() {
    const std::scoped_lock lock(mutex_);
    return poses_;
  }
  /// In its middle, until let_go(). Once.
  void hold_next_scan() { holds_next_ = true; }
  [[nodiscard]] bool holds() {
    return held_.get_future().wait_for(std::chrono::seconds(30)) == std::future_status::ready;
  }
  void let_go() { let_go_.set_value(); }

 private:
  void hear(const Event& event) {
    if (std::holds_alternative<ProfileArrived>(event) && holds_next_.exchange(false)) {
      held_.set_value();
      let_go_.get_future().wait();
    }
    const std::scoped_lock lock(mutex_);
    if (const auto* placed = std::get_if<ScanPlaced>(&event)) {
      said_ += "placed " + std::to_string(placed->pose.id) + " " + to_string(placed->pose.status) + "\n";
      poses_ = placed->all;
    } else if (const auto* stored = std::get_if<ScanStored>(&event)) {
      said_ += "stored " + std::to_string(stored->id) + "\n";
    } else if (const auto* obeyed = std::get_if<OperatorObeyed>(&event)) {
      said_ += obeyed->what + "\n";
      poses_ = obeyed->all;
    } else if (const auto* notice = std::get_if<Notice>(&event)) {
      said_ += notice->text + "\n";
    } else if (const auto* pins = std::get_if<PinsKnown>(&event)) {
      said_ += pins->pins ? "pins of " + std::to_string(pins->pins->tip_diameter_mm) + " mm\n" : "no pins\n";
    } else if (std::holds_alternative<RedMapChanged>(event)) {
      ++red_maps_;
    } else if (const auto* waits = std::get_if<WaitsForOperator>(&event)) {
      ++waits_;
      next_ = waits->next;
    }
    heard_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable heard_;
  std::string said_;
  int red_maps_ = 0;
  int waits_ = 0;
  std::optional<NextView> next_;
  std::vector<ScanPose> poses_;
  std::atomic<bool> holds_next_ = false;
  std::promise<void> held_, let_go_;
  JobContext job_;
  Engine engine_;
  std::optional<Result<EngineResult>> result_;
  std::thread thread_;
};

/// A rig with motors that waits for the key before each scan.
inline EngineOptions driven(const TemporaryFolder& folder) {
  EngineOptions options;
  options.device = "sim:?seed=1&size=20x16x8&spacing=0.25&noise=0.02";
  options.session = folder.path() / "session";
  options.automatic = options.paced = true;
  return options;
}

}  // namespace dubsar::test
