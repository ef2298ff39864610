// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "acquisition/session_store.h"
#include "core/checklist.h"
#include "core/result.h"

namespace dubsar {

/// A range camera on a stage is calibrated by its maker, and its device tells of no rig: what the checklist
/// says of its calibration is kept in the session (document "range_camera") when the device is opened.

/// Which camera it is, how the stage moves it, and its last verification. Nothing is kept of another device.
[[nodiscard]] Status keep_range_camera(SessionStore& store, const std::string& device_uri);

/// Into a checklist that no rig told anything. A record that is not there, or cannot be read, tells nothing.
void tell_of_range_camera(const SessionStore& store, Checklist& list);

}  // namespace dubsar
