// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace dubsar::aravis {

/// Takes out the bytes that a camera puts behind each row to have the next begin at a round address
/// (padding_x of GigE Vision and USB3 Vision): every row then begins where the one before it ends.
inline void close_up_rows(std::uint8_t* pixels, std::size_t rows, std::size_t row_bytes,
                          std::size_t stride_bytes) {
  for (std::size_t row = 1; row < rows; ++row) {
    std::memmove(pixels + row * row_bytes, pixels + row * stride_bytes, row_bytes);
  }
}

}  // namespace dubsar::aravis
