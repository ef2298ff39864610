// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

namespace dubsar {

/// [height*width], 1 within `radius` (a square) of a mark.
[[nodiscard]] std::vector<std::uint8_t> dilated(const std::vector<std::uint8_t>& marks, int height, int width,
                                                int radius);

}  // namespace dubsar
