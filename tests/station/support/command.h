// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

namespace dubsar::test {

using Arguments = std::vector<std::string>;

struct CommandOptions {
  /// Then it is killed and the outcome says so. Nothing takes as long but what hangs: machines that build
  /// beside the tests are slow, and a test that waits is no measure of speed.
  double timeout_s = 240;
  std::uint64_t largest_file = 0;  ///< bytes, RLIMIT_FSIZE; 0: no limit
  bool one_core = false;
  bool bound_by_rights = false;            ///< those of files bind it, though root starts it
  bool refused_threads = false;            ///< the system starts none for it, but those that TBB asks for
  std::vector<std::string> environment{};  ///< NAME=VALUE, besides ours
};

struct Outcome {
  int status = -1;  ///< exit status; -1 when a signal ended it
  int signal = 0;
  bool timed_out = false;
  std::string out;
  std::string err;

  /// Standard output as exactly one JSON object; discarded when it is anything else.
  [[nodiscard]] nlohmann::json json() const;
  /// Lines of standard error that are no log of what went well.
  [[nodiscard]] std::vector<std::string> complaints() const;
};

/// The real command as a child process. One that still runs when this goes is killed.
class RunningCommand {
 public:
  explicit RunningCommand(const Arguments& arguments, const CommandOptions& options = {});
  ~RunningCommand();
  RunningCommand(const RunningCommand&) = delete;
  RunningCommand& operator=(const RunningCommand&) = delete;

  void send(int signal_number) const;
  /// Waits until standard error has the text. False when it ended, or the time is up, without it.
  [[nodiscard]] bool says(const std::string& text, double timeout_s = 240);
  [[nodiscard]] std::string log_until_now();
  Outcome wait();

 private:
  void collect(int file, std::string& into);

  pid_t pid_ = -1;
  std::chrono::steady_clock::time_point deadline_;
  std::mutex mutex_;
  std::string out_;
  std::string err_;
  std::thread out_reader_;
  std::thread err_reader_;
  bool ended_ = false;
  int wait_status_ = 0;
};

Outcome run_command(const Arguments& arguments, const CommandOptions& options = {});

/// What `plan --json` says of the scans alone, without the checklist and the comparison with what is stored.
[[nodiscard]] std::string red_map_of(const Outcome& plan);

[[nodiscard]] std::string bytes_of(const std::filesystem::path& file);

}  // namespace dubsar::test
