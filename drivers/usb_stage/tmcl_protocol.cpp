// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/usb_stage/tmcl_protocol.h"

#include <algorithm>
#include <numeric>

namespace dubsar::usb_stage::tmcl {

std::uint8_t checksum(std::span<const std::uint8_t, kSize - 1> bytes) {
  return static_cast<std::uint8_t>(std::accumulate(bytes.begin(), bytes.end(), 0U));
}

Bytes encode(const Request& request, std::uint8_t module) {
  const auto value = static_cast<std::uint32_t>(request.value);
  Bytes out{module,
            static_cast<std::uint8_t>(request.command),
            request.type,
            request.motor,
            static_cast<std::uint8_t>(value >> 24U),
            static_cast<std::uint8_t>(value >> 16U),
            static_cast<std::uint8_t>(value >> 8U),
            static_cast<std::uint8_t>(value),
            0};
  out[8] = checksum(std::span(out).first<kSize - 1>());
  return out;
}

std::optional<Reply> decode(std::span<const std::uint8_t, kSize> bytes) {
  if (checksum(bytes.first<kSize - 1>()) != bytes[8]) {
    return std::nullopt;
  }
  const std::uint32_t value = std::uint32_t{bytes[4]} << 24U | std::uint32_t{bytes[5]} << 16U |
                              std::uint32_t{bytes[6]} << 8U | std::uint32_t{bytes[7]};
  return Reply{bytes[2], bytes[3], static_cast<std::int32_t>(value)};
}

std::string meaning(std::uint8_t status) {
  switch (status) {
    case 1:
      return "the checksum was wrong";
    case 2:
      return "it does not know the command";
    case 3:
      return "it does not know this type of the command";
    case 4:
      return "it refuses the value";
    case 5:
      return "its memory is locked";
    case 6:
      return "the command is not available";
    default:
      return "status " + std::to_string(status);
  }
}

std::optional<Reply> ReplyFinder::add(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    if (filled_ == kSize) {
      std::shift_left(window_.begin(), window_.end(), 1);
      --filled_;
    }
    window_[filled_++] = byte;
    if (filled_ == kSize) {
      const std::optional<Reply> reply = decode(window_);
      // A module that cannot read the command says so with a command number of 0.
      const bool ours = reply && (reply->command == command_ || reply->status == 1);
      const bool known = reply && (reply->good() || (reply->status >= 1 && reply->status <= 6));
      if (ours && known) {
        filled_ = 0;
        return reply;
      }
    }
  }
  return std::nullopt;
}

}  // namespace dubsar::usb_stage::tmcl
