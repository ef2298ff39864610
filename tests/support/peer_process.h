// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <vector>

extern char** environ;

namespace dubsar::test {

/// A test peer (an emulated device) in a process of its own: it says "ready" or "cannot: WHY" on its standard
/// output, then answers each line of its standard input with one line, and ends when that is closed.
class PeerProcess {
 public:
  explicit PeerProcess(const std::vector<std::string>& words) {
    int to[2] = {-1, -1};
    int from[2] = {-1, -1};
    if (::pipe2(to, O_CLOEXEC) != 0 || ::pipe2(from, O_CLOEXEC) != 0) {
      return;
    }
    posix_spawn_file_actions_t files;
    ::posix_spawn_file_actions_init(&files);
    ::posix_spawn_file_actions_adddup2(&files, to[0], 0);
    ::posix_spawn_file_actions_adddup2(&files, from[1], 1);
    std::vector<char*> arguments;
    for (const std::string& word : words) {
      arguments.push_back(const_cast<char*>(word.c_str()));
    }
    arguments.push_back(nullptr);
    if (::posix_spawnp(&pid_, arguments[0], &files, nullptr, arguments.data(), environ) != 0) {
      pid_ = -1;
    }
    ::posix_spawn_file_actions_destroy(&files);
    ::close(to[0]);
    ::close(from[1]);
    in_ = to[1];
    out_ = from[0];
    first_ = pid_ > 0 ? line() : "cannot: " + words[0] + " does not start";
  }
  /// A peer that another program had before it became this one; see hand_over().
  struct HandedOver {
    const char* text;
  };
  explicit PeerProcess(HandedOver from) {
    if (std::sscanf(from.text, "%d %d %d", &in_, &out_, &pid_) != 3) {
      pid_ = -1;
    }
    ::fcntl(in_, F_SETFD, FD_CLOEXEC);
    ::fcntl(out_, F_SETFD, FD_CLOEXEC);
    first_ = pid_ > 0 ? "ready" : "cannot: no peer was handed over";
  }
  /// For the program that this one is about to become.
  [[nodiscard]] std::string hand_over() const {
    ::fcntl(in_, F_SETFD, 0);
    ::fcntl(out_, F_SETFD, 0);
    return std::to_string(in_) + " " + std::to_string(out_) + " " + std::to_string(pid_);
  }
  ~PeerProcess() {
    ::close(in_);
    if (pid_ > 0) {
      for (int k = 0; k < 300; ++k) {
        if (::waitpid(pid_, nullptr, WNOHANG) != 0) {
          ::close(out_);
          return;
        }
        ::usleep(10000);
      }
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
    ::close(out_);
  }
  PeerProcess(const PeerProcess&) = delete;
  PeerProcess& operator=(const PeerProcess&) = delete;

  /// Empty when the peer is ready; else why it cannot be had here.
  [[nodiscard]] std::string refusal() const { return first_.starts_with("ready") ? std::string() : first_; }
  /// What it said behind "ready ".
  [[nodiscard]] std::string greeting() const { return first_.size() > 6 ? first_.substr(6) : std::string(); }
  [[nodiscard]] pid_t pid() const { return pid_; }

  /// The peer's answer; "none" when it gave none within ten seconds.
  std::string tell(const std::string& command) {
    const std::string text = command + "\n";
    if (::write(in_, text.data(), text.size()) != static_cast<ssize_t>(text.size())) {
      return "none";
    }
    return line();
  }

 private:
  std::string line() {
    for (;;) {
      if (const std::size_t end = pending_.find('\n'); end != std::string::npos) {
        const std::string out = pending_.substr(0, end);
        pending_.erase(0, end + 1);
        return out;
      }
      pollfd waiting{out_, POLLIN, 0};
      char bytes[512];
      if (::poll(&waiting, 1, 10000) <= 0) {
        return "none";
      }
      const ssize_t got = ::read(out_, bytes, sizeof bytes);
      if (got <= 0) {
        return "none";
      }
      pending_.append(bytes, static_cast<std::size_t>(got));
    }
  }
  pid_t pid_ = -1;
  int in_ = -1;
  int out_ = -1;
  std::string pending_, first_;
};

}  // namespace dubsar::test
