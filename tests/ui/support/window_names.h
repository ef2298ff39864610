// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <set>
#include <string>

namespace dubsar::test {

/// What the title bars of the windows on the display (DISPLAY) would say now; empty where there is none.
[[nodiscard]] std::set<std::string> window_names();

}  // namespace dubsar::test
