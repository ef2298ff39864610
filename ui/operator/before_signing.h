// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "station/live_state.h"

namespace dubsar::ui {

/// Scans that stand and were never judged: a run was stopped, or killed, in the middle.
[[nodiscard]] int unjudged_scans(const LiveState& state);

/// The scans that stand and cannot be read: "4, 6"; empty where all can. What is many ends in "…".
[[nodiscard]] std::string damaged_scans(const LiveState& state);
/// Likewise those that were taken out.
[[nodiscard]] std::string damaged_scans_taken_out(const LiveState& state);
/// Likewise those that stand and may have been taken out, since records of them are lost.
[[nodiscard]] std::string scans_of_lost_records(const LiveState& state);
/// Likewise those that stand and take no part in the model: nobody knows for certain where they lie.
[[nodiscard]] std::string scans_without_place(const LiveState& state);

/// Something of the session is known to be damaged, whether it takes part or not.
[[nodiscard]] bool is_damaged(const LiveState& state);
/// Every byte was read for the checklist, and nothing is known to be damaged or lost since.
[[nodiscard]] bool is_session_whole(const LiveState& state);

/// What the signature falls short of, as `sign_verdict` counts it (station/signing.cpp).
struct SigningReason {
  bool asked = false;   ///< a reason may be wanted
  bool wanted = false;  ///< without one it is refused
};

[[nodiscard]] SigningReason signing_reason(const LiveState& state);

}  // namespace dubsar::ui
