// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/command/terminal.h"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <mutex>

#include "station/command/device_wait.h"

namespace dubsar {

namespace {

std::atomic<JobContext*> g_job{nullptr};  // a signal handler has no other way to reach the job
std::atomic<bool> g_bar_stands{false};
std::atomic<bool> g_progress_on{true};
bool g_ends_with_terminal = false;

extern "C" void on_interrupt(int signal_number) {
  end_if_told();
  JobContext* job = g_job.load();
  // Only a person insists. What ends a login, a service or a time limit sends SIGTERM and SIGHUP at once and
  // more than once, in whatever order they are delivered.
  if (job != nullptr && (signal_number != SIGINT || !job->cancelled())) {
    job->cancel();
    return;
  }
  std::signal(signal_number, SIG_DFL);
  std::raise(signal_number);
}

struct Painter {
  std::mutex mutex;
  std::string stage;
  int shown = -1;
  std::chrono::steady_clock::time_point started;
  bool terminal = isatty(STDERR_FILENO) != 0;

  void paint(std::string_view now, double fraction) {
    const std::scoped_lock lock(mutex);
    const int percent = static_cast<int>(100 * fraction);
    if (stage != now) {
      finish_progress();
      stage = now;
      shown = -1;
      started = std::chrono::steady_clock::now();
    }
    const int step = terminal ? percent : percent / 25 * 25;
    if (step == shown) {
      return;
    }
    shown = step;
    if (!terminal) {
      std::fprintf(stderr, "%s: %d %%\n", stage.c_str(), step);
      return;
    }
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - started;
    const double left_s = fraction > 0.02 ? spent.count() * (1 - fraction) / fraction : 0;
    const int filled = percent * 30 / 100;
    std::fprintf(stderr, "\r%-28.28s [%.*s%.*s] %3d %%  %4.0f s left ", stage.c_str(), filled,
                 "##############################", 30 - filled, "..............................", percent,
                 left_s);
    std::fflush(stderr);
    g_bar_stands = true;
  }
};

}  // namespace

JobContext::ProgressSink terminal_progress() {
  auto painter = std::make_shared<Painter>();
  return [painter](std::string_view stage, double fraction) {
    if (g_progress_on) {
      painter->paint(stage, fraction);
    }
  };
}

void show_progress(bool on) {
  g_progress_on = on;
}

void outlive_readers() {
  std::signal(SIGPIPE, SIG_IGN);
}

void finish_progress() {
  if (g_bar_stands.exchange(false)) {
    std::fputc('\n', stderr);
  }
}

InterruptScope::InterruptScope(JobContext& job) {
  g_job = &job;
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
  // A terminal that is closed is no reason to leave a motor running; nohup's wish is.
  g_ends_with_terminal = std::signal(SIGHUP, on_interrupt) != SIG_IGN;
  if (!g_ends_with_terminal) {
    std::signal(SIGHUP, SIG_IGN);
  }
}

InterruptScope::~InterruptScope() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  if (g_ends_with_terminal) {
    std::signal(SIGHUP, SIG_DFL);
  }
  g_job = nullptr;
}

}  // namespace dubsar
