// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <string>

#include "station/live_session.h"

namespace dubsar::test {

inline constexpr const char* kSmallTablet = "sim:?seed=1&size=20x16x8&spacing=0.25&noise=0.02";

/// A session whose changes can be waited for.
class Followed {
 public:
  Followed(const std::string& device, const std::filesystem::path& folder)
      : session({device, folder, std::nullopt}, [this] {
          const std::scoped_lock lock(mutex_);
          ++changes_;
          changed_.notify_all();
        }) {}

  template <class Is>
  [[nodiscard]] bool wait_until(const Is& is) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(60), [&] {
      lock.unlock();
      const bool so = is(session.state());
      lock.lock();
      return so;
    });
  }
  [[nodiscard]] bool wait_for_phase(LivePhase phase) {
    return wait_until([&](const LiveState& state) { return state.phase == phase; });
  }
  [[nodiscard]] bool wait_for_rest() {
    return wait_until([this](const LiveState&) { return !session.busy(); });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int changes_ = 0;

 public:
  LiveSession session;  ///< last: its threads use what stands above
};

}  // namespace dubsar::test
