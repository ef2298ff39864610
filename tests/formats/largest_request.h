// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>

namespace dubsar::test {

/// The largest block that operator new was asked for since it was last forgotten. An executable that links
/// largest_request.cpp counts.
[[nodiscard]] std::size_t largest_request_bytes();
void forget_largest_request();

}  // namespace dubsar::test
