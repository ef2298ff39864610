// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

namespace dubsar {

/// A file's path as it stands in an address: slashes stay, and what no address holds as it is (blanks, #, ?,
/// %, letters beyond ASCII, bytes that are no UTF-8) is percent-encoded.
[[nodiscard]] std::string path_in_address(std::string_view path);

/// The path that stands there so.
[[nodiscard]] std::string path_of_address(std::string_view address);

}  // namespace dubsar
