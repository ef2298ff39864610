// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "tests/station/support/command.h"
#include "build_paths.h"

#include <fcntl.h>
#include <linux/capability.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <fstream>
#include <iterator>
#include <sstream>

namespace dubsar::test {

namespace {

constexpr std::chrono::milliseconds kPoll{2};

void limit_child(const CommandOptions& options) {
  if (options.largest_file > 0) {
    const rlimit limit{options.largest_file, options.largest_file};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  if (options.bound_by_rights) {
    prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE);
    prctl(PR_CAPBSET_DROP, CAP_DAC_READ_SEARCH);
  }
  if (options.refused_threads) {
    // No limit on processes binds root; a stack that no memory has room for stops anybody's threads.
    rlimit stack{};
    getrlimit(RLIMIT_STACK, &stack);
    stack.rlim_cur = std::min(stack.rlim_max, rlim_t{1} << 47U);
    setrlimit(RLIMIT_STACK, &stack);
  }
  if (options.one_core) {
    cpu_set_t cores;
    CPU_ZERO(&cores);
    CPU_SET(sched_getcpu(), &cores);
    sched_setaffinity(0, sizeof cores, &cores);
  }
}

}  // namespace

nlohmann::json Outcome::json() const {
  return nlohmann::json::parse(out, nullptr, false);
}

std::vector<std::string> Outcome::complaints() const {
  std::vector<std::string> found;
  std::istringstream lines(err);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("dubsar: ") || line.starts_with("warning: ") || line.starts_with("error: ")) {
      found.push_back(line);
    }
  }
  return found;
}

RunningCommand::RunningCommand(const Arguments& arguments, const CommandOptions& options)
    : deadline_(std::chrono::steady_clock::now() +
                std::chrono::milliseconds(static_cast<std::int64_t>(1000 * options.timeout_s))) {
  Arguments words{DUBSAR_BINARY_DIR "/bin/dubsar"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) {
    argv.push_back(word.data());
  }
  argv.push_back(nullptr);
  std::vector<char*> environment;
  for (const std::string& one : options.environment) {
    environment.push_back(const_cast<char*>(one.c_str()));
  }
  for (char** one = environ; *one != nullptr; ++one) {
    environment.push_back(*one);
  }
  environment.push_back(nullptr);
  std::array<int, 2> out{};
  std::array<int, 2> err{};
  if (pipe2(out.data(), O_CLOEXEC) != 0 || pipe2(err.data(), O_CLOEXEC) != 0) {
    return;
  }
  pid_ = fork();
  if (pid_ == 0) {
    dup2(out[1], STDOUT_FILENO);
    dup2(err[1], STDERR_FILENO);
    limit_child(options);
    execve(argv[0], argv.data(), environment.data());
    _exit(127);
  }
  close(out[1]);
  close(err[1]);
  out_reader_ = std::thread([this, file = out[0]] { collect(file, out_); });
  err_reader_ = std::thread([this, file = err[0]] { collect(file, err_); });
}

RunningCommand::~RunningCommand() {
  if (!ended_) {
    send(SIGKILL);
    wait();
  }
}

void RunningCommand::collect(int file, std::string& into) {
  std::array<char, 4096> buffer{};
  for (ssize_t got = 0; (got = read(file, buffer.data(), buffer.size())) > 0;) {
    const std::scoped_lock lock(mutex_);
    into.append(buffer.data(), static_cast<std::size_t>(got));
  }
  close(file);
}

void RunningCommand::send(int signal_number) const {
  if (pid_ > 0 && !ended_) {
    kill(pid_, signal_number);
  }
}

std::string RunningCommand::log_until_now() {
  const std::scoped_lock lock(mutex_);
  return err_;
}

bool RunningCommand::says(const std::string& text, double timeout_s) {
  const auto until = std::chrono::steady_clock::now() +
                     std::chrono::milliseconds(static_cast<std::int64_t>(1000 * timeout_s));
  while (std::chrono::steady_clock::now() < until) {
    if (log_until_now().find(text) != std::string::npos) {
      return true;
    }
    if (!ended_ && waitpid(pid_, &wait_status_, WNOHANG) == pid_) {
      ended_ = true;
    }
    if (ended_) {
      return log_until_now().find(text) != std::string::npos;
    }
    std::this_thread::sleep_for(kPoll);
  }
  return false;
}

Outcome RunningCommand::wait() {
  Outcome outcome;
  while (!ended_ && pid_ > 0) {
    if (waitpid(pid_, &wait_status_, WNOHANG) == pid_) {
      ended_ = true;
    } else if (std::chrono::steady_clock::now() > deadline_ && !outcome.timed_out) {
      outcome.timed_out = true;
      kill(pid_, SIGKILL);
    } else {
      std::this_thread::sleep_for(kPoll);
    }
  }
  for (std::thread* reader : {&out_reader_, &err_reader_}) {
    if (reader->joinable()) {
      reader->join();
    }
  }
  outcome.status = WIFEXITED(wait_status_) ? WEXITSTATUS(wait_status_) : -1;
  outcome.signal = WIFSIGNALED(wait_status_) ? WTERMSIG(wait_status_) : 0;
  outcome.out = out_;
  outcome.err = err_;
  return outcome;
}

Outcome run_command(const Arguments& arguments, const CommandOptions& options) {
  return RunningCommand(arguments, options).wait();
}

std::string red_map_of(const Outcome& plan) {
  auto json = nlohmann::ordered_json::parse(plan.out, nullptr, false);
  if (!json.is_object()) {
    return plan.out;
  }
  json.erase("left_out");
  json.erase("checklist");
  json.erase("stored");
  return json.dump();
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace dubsar::test
