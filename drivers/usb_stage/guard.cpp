// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/usb_stage/guard.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <utility>

namespace dubsar::usb_stage {

namespace {

/// Beside the plugin that this code is in.
std::filesystem::path program() {
  Dl_info here{};
  if (::dladdr(reinterpret_cast<const void*>(&program), &here) == 0 || here.dli_fname == nullptr) {
    return {};
  }
  return std::filesystem::path(here.dli_fname).parent_path() / "usb_stage_guard";
}

std::string hex_of(const std::string& bytes) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string out;
  for (const char byte : bytes) {
    out += kDigits[static_cast<unsigned char>(byte) >> 4U];
    out += kDigits[static_cast<unsigned char>(byte) & 0xfU];
  }
  return out;
}

}  // namespace

Result<std::unique_ptr<Guard>> Guard::start(const UsbName& name, const std::string& panic) {
  const std::string path = program().string();
  const std::string controller = name.text();
  const std::string bytes = hex_of(panic);
  int ends[2] = {-1, -1};
  int told[2] = {-1, -1};
  pid_t process = -1;
  const auto refuse = [&](int number) -> std::unexpected<Error> {
    if (process > 0) {  // one that started and says nothing guards nothing
      ::kill(process, SIGKILL);
      ::waitpid(process, nullptr, 0);
    }
    for (const int end : {ends[0], ends[1], told[0], told[1]}) {
      if (end >= 0) {
        ::close(end);
      }
    }
    return fail(ErrorKind::kDevice, std::string("the laser's guard does not start: ") + std::strerror(number),
                path, "try again, or reinstall: without it no laser goes on");
  };
  if (::pipe2(ends, O_CLOEXEC) != 0 || ::pipe2(told, O_CLOEXEC) != 0) {
    return refuse(errno);
  }
  posix_spawn_file_actions_t files;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawn_file_actions_adddup2(&files, ends[0], 0);
  ::posix_spawn_file_actions_adddup2(&files, told[1], 1);
  char* words[] = {const_cast<char*>(path.c_str()), const_cast<char*>(controller.c_str()),
                   const_cast<char*>(bytes.c_str()), nullptr};
  const int failed = ::posix_spawn(&process, path.c_str(), &files, nullptr, words, environ);
  ::posix_spawn_file_actions_destroy(&files);
  if (failed != 0) {
    return refuse(failed);
  }
  ::close(std::exchange(told[1], -1));
  ::close(std::exchange(ends[0], -1));
  // It says one byte once no signal of ours reaches it.
  pollfd waiting{told[0], POLLIN, 0};
  char said = 0;
  int heard = -1;
  do {
    heard = ::poll(&waiting, 1, 2000);
  } while (heard < 0 && errno == EINTR);
  if (heard <= 0 || ::read(told[0], &said, 1) != 1) {
    return refuse(ETIMEDOUT);
  }
  ::close(told[0]);
  return std::unique_ptr<Guard>(new Guard(ends[1], process));
}

void Guard::say(char word) {
  // SIGPIPE must not end a program whose guard was killed.
  sigset_t pipe_signal;
  sigset_t before;
  sigemptyset(&pipe_signal);
  sigaddset(&pipe_signal, SIGPIPE);
  ::pthread_sigmask(SIG_BLOCK, &pipe_signal, &before);
  const ssize_t sent = ::write(pipe_, &word, 1);
  if (sent < 0 && errno == EPIPE) {
    const timespec at_once{};
    ::sigtimedwait(&pipe_signal, nullptr, &at_once);
  }
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

void Guard::lit(bool on) {
  if (std::exchange(lit_, on) != on) {
    say(on ? '!' : '-');
  }
}

void Guard::seek() {
  if (!std::exchange(seeks_, true)) {
    say('?');
  }
}

void Guard::leave_it_to_you() {
  ::close(std::exchange(pipe_, -1));
}

Guard::~Guard() {
  if (pipe_ < 0) {
    return;  // at work; not waited for
  }
  say('.');  // and no signal: one that ended in the middle of its bytes would leave half of them on the line
  ::close(pipe_);
  ::waitpid(process_, nullptr, 0);
}

}  // namespace dubsar::usb_stage
