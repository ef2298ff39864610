// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <memory>
#include <mutex>
#include <utility>

#include "drivers/usb_stage/link.h"

namespace dubsar::usb_stage {

/// A link that an emergency stop shuts: the bytes that end motion and light are then the last that go out,
/// and what another thread was about to ask for does not follow them. Answers still come in: one that nobody
/// waits for would be taken for that to the next question.
class Gate : public Link {
 public:
  explicit Gate(std::unique_ptr<Link> link) : link_(std::move(link)) {}

  /// kCancelled while it is shut.
  Status write(std::string_view bytes) override {
    const std::lock_guard lock(mutex_);
    return shut_ ? fail(ErrorKind::kCancelled, "the emergency stop was pressed") : link_->write(bytes);
  }
  Result<std::string> read(std::chrono::milliseconds timeout) override { return link_->read(timeout); }

  /// Sends these bytes, and nothing of write() from here on.
  Status shut(std::string_view last) {
    const std::lock_guard lock(mutex_);
    shut_ = true;
    return link_->write(last);
  }
  void open() {
    const std::lock_guard lock(mutex_);
    shut_ = false;
  }
  [[nodiscard]] bool is_shut() {
    const std::lock_guard lock(mutex_);
    return shut_;
  }

 private:
  const std::unique_ptr<Link> link_;
  std::mutex mutex_;  ///< of writing
  bool shut_ = false;
};

}  // namespace dubsar::usb_stage
