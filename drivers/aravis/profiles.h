// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <atomic>

#include "core/result.h"
#include "drivers/aravis/camera.h"
#include "drivers/driver.h"

namespace dubsar::aravis {

/// Runs one scan of a range camera into the sink, from begin to end: as many profiles as its options say, row
/// by row. A frame is a block of profiles; blocks that were lost on the way, whole or in part, leave a gap in
/// the row numbers. kCancelled when the sink or `stopped` ended it, kDevice when the camera went, sends
/// nothing or does not end its stream (a laser of its own may be on); end() has been called whenever begin()
/// was.
Status run_scan(Camera& camera, const dubsar_sink& sink, const std::atomic<bool>& stopped);

}  // namespace dubsar::aravis
