// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "acquisition/rig_parts.h"
#include "acquisition/rig_source.h"
#include "drivers/device.h"
#include "formats/rig_toml.h"

namespace dubsar {

/// A range camera that yields profiles by itself, and a stage that moves it (or the tablet) meanwhile: each
/// profile goes where the stage was at its time. Use from one thread at a time; stop() from any.
class RangeRig : public RigSource {
 public:
  /// What the file has to say of a range camera, before anything is opened. Errors: kUsage, kBadInput.
  static Status check(const RigFile& file, const std::string& where);
  /// Checks that the parts fit: a camera that yields profiles, a stage with the axis that tells where it is
  /// while it moves, a motion and a speed in the file, a scan within the axis' limits. Errors: kUsage,
  /// kBadInput, kDevice.
  [[nodiscard]] static Result<RangeRig> make(const RigFile& file, Device camera, Device stage,
                                             const std::string& where);

  /// One scan; the stage is homed before the first, where it has to be. A laser of the stage is lit
  /// meanwhile, where it has one.
  Status scan(ProfileSink& sink) override;
  Status stop() override;
  Status halt() override;
  [[nodiscard]] const Rig* geometry() const override { return nullptr; }

 private:
  RangeRig(const RigFile& file, Device camera, Device stage, StageAxis axis, std::string device_id);
  /// Lights the laser; `dark` puts it off when it goes.
  Status run(ProfileSink& sink, std::optional<LaserGuard>& dark);

  RigFile file_;
  Device camera_;
  Device stage_;
  StageAxis axis_;
  std::string device_id_;
  std::unique_ptr<std::atomic<bool>> stopped_;
};

}  // namespace dubsar
