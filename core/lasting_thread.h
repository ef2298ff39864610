// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <mutex>
#include <stop_token>
#include <thread>

namespace dubsar {

/// One thread that lives until the program ends, for calls into libraries that keep something for every
/// thread that ever called them.
class LastingThread {
 public:
  LastingThread();
  ~LastingThread() = default;
  LastingThread(const LastingThread&) = delete;
  LastingThread& operator=(const LastingThread&) = delete;

  /// Runs work there, one after the other with that of others, and returns when it is done. What it throws is
  /// thrown here. Not to be called from work itself.
  void run(const std::function<void()>& work);

 private:
  void serve(const std::stop_token& enough);

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<std::packaged_task<void()>> waiting_;
  std::jthread thread_;  ///< last: it ends before what it uses
};

}  // namespace dubsar
