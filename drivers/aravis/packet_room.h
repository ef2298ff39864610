// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace dubsar::aravis {

/// What a camera's packets are to wait in at most, where they are not taken raw.
constexpr std::uint64_t kSocketBytes = std::uint64_t{32} << 20U;

/// Bytes that the kernel grants a socket that asks for `wanted` (net.core.rmem_max is the limit); nothing
/// when it does not say.
[[nodiscard]] std::optional<std::uint64_t> granted_bytes(std::uint64_t wanted);

/// Whether this program may take packets raw, past that limit: as root, or with the capability CAP_NET_RAW.
[[nodiscard]] bool may_take_raw_packets();

/// What to say when frames of `frame_bytes` have too little room to wait in; nothing where they have enough.
[[nodiscard]] std::optional<std::string> scarce_room(std::uint64_t granted, std::uint64_t frame_bytes);

}  // namespace dubsar::aravis
