// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "tests/ui/support/display.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <vector>

namespace dubsar::test {

namespace {

constexpr int kPatienceMs = 20000;

}  // namespace

Display::Display(const std::string& size, bool with_opengl) {
  std::array<int, 2> pipe_ends{};
  if (pipe(pipe_ends.data()) != 0) {
    return;
  }
  pid_ = fork();
  if (pid_ == 0) {
    close(pipe_ends[0]);
    std::vector<std::string> words{"Xvfb",      "-displayfd", std::to_string(pipe_ends[1]),
                                   "-screen",   "0",          size,
                                   "-nolisten", "tcp",        "-noreset"};
    if (!with_opengl) {
      words.insert(words.end(), {"-extension", "GLX"});
    }
    std::vector<char*> argv;
    for (std::string& word : words) {
      argv.push_back(word.data());
    }
    argv.push_back(nullptr);
    const int null = open("/dev/null", O_WRONLY);
    dup2(null, STDERR_FILENO);
    execvp(argv[0], argv.data());
    _exit(127);
  }
  close(pipe_ends[1]);
  // The number comes with a line end once the display takes clients; its digits may come one by one.
  std::string text;
  pollfd answer{pipe_ends[0], POLLIN, 0};
  char digit = 0;
  while (text.find('\n') == std::string::npos && poll(&answer, 1, kPatienceMs) == 1 &&
         read(pipe_ends[0], &digit, 1) == 1) {
    text += digit;
  }
  if (text.find('\n') != std::string::npos) {
    number_ = std::atoi(text.c_str());
    std::string name = ":";
    name += std::to_string(number_);
    setenv("DISPLAY", name.c_str(), 1);
    setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
  }
  close(pipe_ends[0]);
}

Display::~Display() {
  if (pid_ > 0) {
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
    unsetenv("DISPLAY");
  }
}

}  // namespace dubsar::test
