// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "acquisition/session_store.h"
#include "core/result.h"
#include "station/verification.h"

namespace dubsar {

/// Keeps a calibration in the session as its file stands today: that may be written anew before the tablet is
/// exported. As the document "calibration TIME", or "calibration TIME 2" and so on where another one says of
/// itself that it was made at that time; nothing new where it is kept already.
[[nodiscard]] Status keep_calibration(SessionStore& store, const CalibrationFile& calibration);

}  // namespace dubsar
