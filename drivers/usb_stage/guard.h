// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <memory>
#include <string>

#include "core/result.h"
#include "drivers/usb_stage/usb_link.h"

namespace dubsar::usb_stage {

/// A process of its own that outlives this one by a moment: when this one ends in whatever way (also by
/// SIGKILL), it opens the controller and sends the bytes that put its lasers off. A handler of signals could
/// not: it may not call libusb, and no signal tells of SIGKILL.
class Guard {
 public:
  /// kDevice when the guard's program is not beside the plugin or does not start: then no laser may go on.
  [[nodiscard]] static Result<std::unique_ptr<Guard>> start(const UsbName& name, const std::string& panic);
  /// Sends the guard home: the lasers are off, and it has nothing to do.
  ~Guard();
  /// The lasers may be on and cannot be reached from here: the guard tries for some seconds by itself.
  void leave_it_to_you();
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;

 private:
  Guard(int pipe, int process) : pipe_(pipe), process_(process) {}
  int pipe_;
  int process_;
};

}  // namespace dubsar::usb_stage
