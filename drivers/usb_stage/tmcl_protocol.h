// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

/// Trinamic's motion control language, direct mode: nine bytes each way, one command outstanding.
namespace dubsar::usb_stage::tmcl {

inline constexpr std::size_t kSize = 9;
using Bytes = std::array<std::uint8_t, kSize>;

enum class Command : std::uint8_t {
  kMotorStop = 3,
  kMoveTo = 4,
  kSetAxis = 5,
  kGetAxis = 6,
  kReference = 13,
  kSetOutput = 14,
  kVersion = 136
};
enum class AxisParameter : std::uint8_t {
  kTarget = 0,
  kActual = 1,
  kActualSpeed = 3,
  kMaxSpeed = 4,
  kReached = 8
};

struct Request {
  Command command = Command::kMotorStop;
  std::uint8_t type = 0;
  std::uint8_t motor = 0;
  std::int32_t value = 0;
};

struct Reply {
  std::uint8_t status = 0;
  std::uint8_t command = 0;
  std::int32_t value = 0;

  [[nodiscard]] bool good() const { return status == 100 || status == 101; }
};

/// Sum of the first eight bytes, modulo 256.
[[nodiscard]] std::uint8_t checksum(std::span<const std::uint8_t, kSize - 1> bytes);
[[nodiscard]] Bytes encode(const Request& request, std::uint8_t module = 1);
/// Nothing when the checksum is wrong.
[[nodiscard]] std::optional<Reply> decode(std::span<const std::uint8_t, kSize> bytes);
/// What a reply's status means, for people.
[[nodiscard]] std::string meaning(std::uint8_t status);

/// Finds the reply to a command in bytes as they come, whatever garbage stands before it.
class ReplyFinder {
 public:
  explicit ReplyFinder(Command command) : command_(static_cast<std::uint8_t>(command)) {}
  [[nodiscard]] std::optional<Reply> add(std::span<const std::uint8_t> bytes);

 private:
  std::uint8_t command_;
  Bytes window_{};
  std::size_t filled_ = 0;
};

}  // namespace dubsar::usb_stage::tmcl
