// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/lasting_thread.h"

#include <utility>

namespace dubsar {

LastingThread::LastingThread() : thread_([this](const std::stop_token& enough) { serve(enough); }) {}

void LastingThread::run(const std::function<void()>& work) {
  std::packaged_task<void()> task(work);
  std::future<void> done = task.get_future();
  {
    const std::scoped_lock lock(mutex_);
    waiting_.push_back(std::move(task));
  }
  changed_.notify_one();
  done.get();
}

void LastingThread::serve(const std::stop_token& enough) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, enough, [this] { return !waiting_.empty(); })) {
    std::packaged_task<void()> task = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    task();
    lock.lock();
  }
}

}  // namespace dubsar
