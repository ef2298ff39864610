// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "core/pin_set.h"
#include "station/operator_hint.h"
#include "station/tablet_record.h"

namespace dubsar {

// What the operator can ask of a running engine: the same as `dubsar session` does to one that stands still.
struct DropScan {
  int id = -1;  ///< -1: the newest that stands
  std::string why;
};
/// Takes a scan out, and proposes its view as the next, where the rig was driven to it: behind the scan under
/// way, if there is one, and whatever else is said meanwhile.
struct ScanAgain {
  int id = 0;
};
struct RestoreScan {
  int id = 0;
};
struct HintScan {
  int id = 0;
  GivenHint given;
};
struct WithdrawHint {
  int id = 0;
};
/// Fixes a registered scan where it is.
struct LockScan {
  int id = 0;
};
struct UnlockScan {
  int id = 0;
};

/// Says which pin is which in a scan, in place of what was said before (seed 001, 3.2); no tips takes it
/// back. Another diameter than before changes what is clay in every scan, and all are registered anew.
struct LabelPins {
  int id = 0;
  std::vector<PinTip> tips;
  double tip_diameter_mm = 1.0;
};

/// Says what tablet it is.
struct DescribeTablet {
  TabletRecord record;
};
/// Changes a setting of the open device, between two scans; kept in the session.
struct ChangeSetting {
  std::string key;
  std::string word;
};
/// Of a paced run: shows what the camera sees while the operator is waited for.
struct WatchCamera {
  bool on = false;
};
/// Of a paced run: the tablet lies as it was asked for; scan it.
struct ScanNow {};
/// Of a paced run: take no more scans, and bring what there is to its end.
struct Finish {};

/// Whoever looks at it goes away: where a cancelled run would give up the scan under way, its rows are kept.
struct KeepHalfScan {};

using OperatorCommand =
    std::variant<DropScan, ScanAgain, RestoreScan, HintScan, WithdrawHint, LockScan, UnlockScan, LabelPins,
                 DescribeTablet, ChangeSetting, WatchCamera, ScanNow, Finish, KeepHalfScan>;

}  // namespace dubsar
