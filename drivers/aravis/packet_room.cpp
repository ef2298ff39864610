// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/aravis/packet_room.h"

#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>

namespace dubsar::aravis {

namespace {
/// With so much no frame was lost up to 385 MB/s, with Debian's 208 KiB nearly every one.
constexpr std::uint64_t kEnough = std::uint64_t{4} << 20U;
}  // namespace

std::optional<std::uint64_t> granted_bytes(std::uint64_t wanted) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket < 0) {
    return std::nullopt;
  }
  const int asked = static_cast<int>(wanted);
  int doubled = 0;  // socket(7): the kernel adds as much for its own use
  socklen_t size = sizeof doubled;
  const bool told = ::setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &asked, sizeof asked) == 0 &&
                    ::getsockopt(socket, SOL_SOCKET, SO_RCVBUF, &doubled, &size) == 0;
  ::close(socket);
  return told ? std::optional(static_cast<std::uint64_t>(doubled) / 2) : std::nullopt;
}

bool may_take_raw_packets() {
  const int socket = ::socket(AF_PACKET, SOCK_RAW | SOCK_CLOEXEC, htons(ETH_P_ALL));
  if (socket >= 0) {
    ::close(socket);
  }
  return socket >= 0;
}

std::optional<std::string> scarce_room(std::uint64_t granted, std::uint64_t frame_bytes) {
  const std::uint64_t needed = std::clamp(frame_bytes, kEnough, kSocketBytes);
  if (granted >= needed) {
    return std::nullopt;
  }
  return "frames may be lost: this machine keeps " + std::to_string(granted / 1024) +
         " KiB of a camera's packets, a frame asks for " + std::to_string(needed / 1024) +
         "; as root: sysctl -w net.core.rmem_max=" + std::to_string(kSocketBytes);
}

}  // namespace dubsar::aravis
