// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

namespace dubsar {

/// The number at `from`, which need not be aligned. `order` is the byte order of the bytes.
template <class T>
[[nodiscard]] T load(const char* from, std::endian order = std::endian::little) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  if (order != std::endian::native) {
    std::reverse(bytes.begin(), bytes.end());
  }
  return std::bit_cast<T>(bytes);
}

/// Appends the number's bytes.
template <class T>
void append(std::string& to, T value, std::endian order = std::endian::little) {
  auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if (order != std::endian::native) {
    std::reverse(bytes.begin(), bytes.end());
  }
  to.append(bytes.data(), bytes.size());
}

}  // namespace dubsar
