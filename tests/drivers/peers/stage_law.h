// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <optional>
#include <string>

namespace dubsar::test {

/// Where an emulated stage is at any time: it goes from one position to another at one speed. Times are
/// seconds of CLOCK_MONOTONIC, which all processes share.
struct StageLaw {
  double from = 0, target = 0, speed = 1, started = 0, laser = 0, stuck = 0;

  [[nodiscard]] double at(double now) const {
    const double way = target - from;
    const double gone = stuck != 0 ? 0 : (now - started) * speed;
    return gone >= std::abs(way) && stuck == 0 ? target : from + (way < 0 ? -gone : gone);
  }
  /// When it passes a position; nothing when it does not on this way.
  [[nodiscard]] std::optional<double> when(double position) const {
    const double part = target == from ? -1 : (position - from) / (target - from);
    if (stuck != 0 || part < 0 || part > 1) {
      return std::nullopt;
    }
    return started + std::abs(position - from) / speed;
  }
};

/// A law that another process can read, through a file in memory: what a camera sees follows where the stage
/// stands. One writes, others read.
class SharedLaw {
 public:
  explicit SharedLaw(const std::string& path) {
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (file >= 0 && ::ftruncate(file, sizeof(Shared)) == 0) {
      void* const at = ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
      shared_ = at == MAP_FAILED ? nullptr : static_cast<Shared*>(at);
    }
    ::close(file);
  }
  ~SharedLaw() {
    if (shared_ != nullptr) {
      ::munmap(shared_, sizeof(Shared));
    }
  }
  SharedLaw(const SharedLaw&) = delete;
  SharedLaw& operator=(const SharedLaw&) = delete;

  [[nodiscard]] bool works() const { return shared_ != nullptr; }
  void write(const StageLaw& law) {
    const double values[kValues] = {law.from, law.target, law.speed, law.started, law.laser, law.stuck};
    ++shared_->version;  // odd: being written
    for (int k = 0; k < kValues; ++k) {
      shared_->values[k].store(values[k]);
    }
    ++shared_->version;
  }
  [[nodiscard]] StageLaw read() const {
    for (;;) {
      const unsigned before = shared_->version;
      double values[kValues];
      for (int k = 0; k < kValues; ++k) {
        values[k] = shared_->values[k].load();
      }
      if (before % 2 == 0 && shared_->version == before) {
        return {values[0], values[1], values[2], values[3], values[4], values[5]};
      }
    }
  }

 private:
  static constexpr int kValues = 6;
  struct Shared {
    std::atomic<unsigned> version;
    std::atomic<double> values[kValues];
  };
  Shared* shared_ = nullptr;
};

}  // namespace dubsar::test
