// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/result.h"
#include "core/rig.h"
#include "drivers/device.h"

namespace dubsar {

/// A range source that is put together of other devices.
class RigSource {
 public:
  RigSource() = default;
  RigSource(RigSource&&) = default;
  RigSource& operator=(RigSource&&) = default;
  virtual ~RigSource() = default;
  virtual Status scan(ProfileSink& sink) = 0;
  /// From any thread: a scan that runs returns kCancelled soon.
  virtual Status stop() = 0;
  /// From any thread: the stage's emergency stop; a scan that runs returns kCancelled soon.
  virtual Status halt() = 0;
  /// What is known of its geometry; nullptr when nothing is.
  [[nodiscard]] virtual const Rig* geometry() const = 0;
  /// Of a rig that can be looked through between scans; nullptr where none can.
  [[nodiscard]] virtual Device* camera() { return nullptr; }
  virtual Status start_view() { return fail(ErrorKind::kUsage, "this rig has no camera to look through"); }
  virtual Status stop_view() { return {}; }
  /// While it is looked through: its laser as a scan has it, or off.
  virtual Status light_view(bool /*lit*/) {
    return fail(ErrorKind::kUsage, "this rig has no camera to look through");
  }
};

}  // namespace dubsar
