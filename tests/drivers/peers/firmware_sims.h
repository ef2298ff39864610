// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "tests/drivers/peers/stage_law.h"

namespace dubsar::test {

/// What runs on the board of an emulated controller. Its motors take the time that they take.
class FirmwareSim {
 public:
  virtual ~FirmwareSim() = default;
  /// Bytes from the line; answers are appended to out. `now` is in seconds.
  virtual void take(std::string_view bytes, double now) = 0;
  virtual void power_up() = 0;
  std::string out;
  double laser = 0;         ///< of the brightest one, 0 to 1
  bool impossible = false;  ///< reports positions that cannot be
  bool stuck = false;       ///< the motor does not turn
  [[nodiscard]] StageLaw law() const { return {from_, target_, speed_, started_, laser, stuck ? 1.0 : 0.0}; }
  [[nodiscard]] double at(double now) const { return law().at(now); }
  [[nodiscard]] bool moving(double now) const { return at(now) != target_; }

 protected:
  void go(double target, double speed, double now) {
    from_ = at(now);
    target_ = target;
    speed_ = speed;
    started_ = now;
  }
  void hold(double now) { from_ = target_ = at(now); }
  void set(double position) { from_ = target_ = position; }
  double from_ = 0, target_ = 0, speed_ = 1, started_ = 0;
};

/// grbl, horus, tmcl; of these also grbl-without-switches, and horus-silent, which answers no `?` and says ok
/// when the table stands, or when the move is accepted: horus-silent-quick; and tmcl-heavy, whose first motor
/// takes 4 s to stand.
[[nodiscard]] std::unique_ptr<FirmwareSim> make_firmware_sim(const std::string& name);

}  // namespace dubsar::test
