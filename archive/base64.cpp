// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/base64.h"

namespace dubsar {

std::string base64(std::span<const std::uint8_t> bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t have = bytes.size() - i;
    const std::uint32_t group = (std::uint32_t{bytes[i]} << 16U) |
                                (have > 1 ? std::uint32_t{bytes[i + 1]} << 8U : 0U) |
                                (have > 2 ? std::uint32_t{bytes[i + 2]} : 0U);
    text += kDigits[(group >> 18U) & 63U];
    text += kDigits[(group >> 12U) & 63U];
    text += have > 1 ? kDigits[(group >> 6U) & 63U] : '=';
    text += have > 2 ? kDigits[group & 63U] : '=';
  }
  return text;
}

}  // namespace dubsar
