// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "bench/support/opened_view.h"

namespace dubsar::bench {

/// Prints frames a second while it is turned, every face drawn, in several lights and as the window turns
/// it, each with its ratio to a bare indexed draw of the same faces on the same card; then what it takes to
/// select all.
void time_frames(OpenedView& opened);

}  // namespace dubsar::bench
