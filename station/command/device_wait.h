// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/result.h"
#include "station/command/command.h"
#include "station/device_patience.h"

namespace dubsar {

/// Ends the program at once, with the error's line and its exit status: whoever would end it in good order
/// waits for a driver. From any thread, also of several; what the disk holds is whole at any moment.
[[noreturn]] void end_without_device(const Error& error, bool json);

/// Of a signal handler: ends the program likewise where patience_with_device has told of a device that has
/// not come back; else returns.
void end_if_told();

/// Of a verb that drives a device, while it does: once it was stopped, a device that does not come back is
/// told of after kSilentAfter; from then on until it comes back any signal, and kGivenUpAfter without one,
/// ends the program.
[[nodiscard]] DevicePatience patience_with_device(const CommandContext& context);

}  // namespace dubsar
