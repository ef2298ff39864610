// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "tests/station/support/faulted_command.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <thread>

#include "build_paths.h"
#include "formats/atomic_file.h"

namespace dubsar::test {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLogBytes = 512;

/// What storage_faults.c shares with us.
class FaultLog {
 public:
  explicit FaultLog(const fs::path& path) {
    std::ofstream(path, std::ios::binary) << std::string(kLogBytes, '\0');
    const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    bytes_ = static_cast<const char*>(::mmap(nullptr, kLogBytes, PROT_READ, MAP_SHARED, fd, 0));
    ::close(fd);
  }
  ~FaultLog() { ::munmap(const_cast<char*>(bytes_), kLogBytes); }
  FaultLog(const FaultLog&) = delete;
  FaultLog& operator=(const FaultLog&) = delete;
  [[nodiscard]] std::int64_t calls() const {
    std::int64_t count = 0;
    std::memcpy(&count, bytes_, sizeof count);
    return count;
  }
  [[nodiscard]] std::string met() const { return bytes_ + sizeof(std::int64_t); }

 private:
  const char* bytes_ = nullptr;
};

std::vector<fs::path> left_over(const fs::path& folder) {
  std::vector<fs::path> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().filename().string().starts_with(kTemporaryPrefix)) {
      out.push_back(entry.path());
    }
  }
  return out;
}

void look_at_command(const Fault& fault, const fs::path& folder, TrialOutcome& out) {
  const auto say = [&](const std::string& what) { out.faults.push_back(what); };
  const Outcome& command = out.command;
  if (command.timed_out) {
    say("it hung");
  } else if (command.signal != 0 && !out.killed) {
    say("it died of signal " + std::to_string(command.signal));
  }
  if (!out.killed) {
    const auto lines = command.complaints();
    const auto errors =
        std::ranges::count_if(lines, [](const std::string& line) { return line.starts_with("dubsar: "); });
    if (command.status > 1 && errors != 1) {
      say("status " + std::to_string(command.status) + " with " + std::to_string(errors) +
          " lines that say why");
    }
    if (command.status != 0 && command.status != 1 && command.status != 4) {
      say("status " + std::to_string(command.status) + " for a disk that refuses: " + command.err);
    }
    // A disk that takes nothing any more does not let go of files either, unless it is only full.
    const bool may_clean_up = !fault.stays || fault.what == "ENOSPC" || fault.what == "EDQUOT";
    for (const fs::path& path : may_clean_up ? left_over(folder) : std::vector<fs::path>()) {
      say("left behind: " + path.filename().string());
    }
  }
}

}  // namespace

TrialOutcome run_with_fault(const Arguments& arguments, const fs::path& folder, const fs::path& log_file,
                            const Fault& fault) {
  const FaultLog log(log_file);
  CommandOptions options;
  options.environment = {"LD_PRELOAD=" DUBSAR_BINARY_DIR
                         "/lib/dubsar/test_support/libdubsar_storage_faults.so",
                         "DUBSAR_FAULT_ROOT=" + folder.string(),
                         "DUBSAR_FAULT_LOG=" + log_file.string(),
                         "DUBSAR_FAULT_AT=" + std::to_string(fault.at),
                         "DUBSAR_FAULT_DO=" + fault.what,
                         std::string("DUBSAR_FAULT_STAYS=") + (fault.stays ? "1" : "0")};
  TrialOutcome out;
  const auto start = std::chrono::steady_clock::now();
  RunningCommand running(arguments, options);
  if (fault.kill_after_s >= 0) {
    std::this_thread::sleep_for(std::chrono::duration<double>(fault.kill_after_s));
    running.send(SIGKILL);
  }
  out.command = running.wait();
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  out.calls = log.calls();
  out.met = log.met();
  out.killed = out.command.signal == SIGKILL && !out.command.timed_out;
  look_at_command(fault, folder, out);
  return out;
}

Arguments filled_in(Arguments arguments, const std::vector<std::pair<std::string, std::string>>& names) {
  for (std::string& word : arguments) {
    for (const auto& [name, value] : names) {
      if (const std::size_t at = word.find(name); at != std::string::npos) {
        word.replace(at, name.size(), value);
      }
    }
  }
  return arguments;
}

}  // namespace dubsar::test
