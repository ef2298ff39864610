// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <variant>

#include "station/operator_hint.h"

namespace dubsar {

// What the operator can ask of a running engine: the same as `dubsar session` does to one that stands still.
struct DropScan {
  int id = -1;  ///< -1: the newest that stands
  std::string why;
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

using OperatorCommand = std::variant<DropScan, RestoreScan, HintScan, WithdrawHint, LockScan, UnlockScan>;

}  // namespace dubsar
