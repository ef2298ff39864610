// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <memory>
#include <string>

#include "core/result.h"
#include "drivers/usb_stage/usb_link.h"

namespace dubsar::usb_stage {

/// A process of its own that outlives this one: when this one ends in whatever way (also by SIGKILL), or says
/// that the controller is out of reach, it opens the controller as soon as it is there and sends the bytes
/// that put its lasers off. A handler of signals could not: it may not call libusb, and no signal tells of
/// SIGKILL.
class Guard {
 public:
  /// kDevice when the guard's program is not beside the plugin or does not start: then no laser may go on.
  [[nodiscard]] static Result<std::unique_ptr<Guard>> start(const UsbName& name, const std::string& panic);
  /// Sends the guard home, and waits until it has let go of the controller: some milliseconds, or as long as
  /// it takes to send its bytes.
  ~Guard();
  /// Whether lasers are on. While they are, the guard looks whether this program was suspended (Ctrl-Z), and
  /// has it end: nothing else would ever put them off.
  void lit(bool on);
  /// The lasers may be on and cannot be reached from here: the guard looks for the controller from now on.
  /// Nobody else opens it until this guard is sent home.
  void seek();
  [[nodiscard]] bool seeks() const { return seeks_; }
  /// The same, for longer than this program lives: the guard goes by itself, after ten minutes at most.
  void leave_it_to_you();
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;

 private:
  Guard(int pipe, int process) : pipe_(pipe), process_(process) {}
  void say(char word);
  int pipe_;
  int process_;
  bool lit_ = false;
  bool seeks_ = false;
};

}  // namespace dubsar::usb_stage
