// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

namespace dubsar {

/// What to say of a file whose body holds more than its header tells of: damage as much as one that is cut
/// short, though all that was told of is there. `rest`: what follows; empty where that is nothing but blanks,
/// as text ends in.
[[nodiscard]] std::string bytes_left_over(std::string_view rest);

}  // namespace dubsar
