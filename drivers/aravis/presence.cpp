// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/aravis/presence.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>

namespace dubsar::aravis {

namespace {
// GigE Vision 1.2, 14.3: the control port, and DISCOVERY_CMD with its acknowledgement asked for.
constexpr std::uint16_t kControlPort = 3956;
constexpr std::uint8_t kKey = 0x42;
constexpr std::uint8_t kAcknowledge = 0x01;
constexpr std::uint8_t kDiscovery = 0x02;
}  // namespace

Presence::Presence(std::uint32_t address) {
  socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(kControlPort);
  to.sin_addr.s_addr = address;
  // Connected: answers of others are not ours, and a refusal comes back as an error.
  if (socket_ >= 0 && ::connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) {
    ::close(socket_);
    socket_ = -1;
  }
}

Presence::~Presence() {
  if (socket_ >= 0) {
    ::close(socket_);
  }
}

void Presence::quiet() {
  looked_ = Clock::now();
  silent_ = {};
  answered_ = false;
}

bool Presence::gone() {
  if (socket_ < 0) {
    return false;  // cannot tell: control-lost will
  }
  const Clock::time_point now = Clock::now();
  silent_ += std::min<Clock::duration>(now - looked_, kAskEvery);
  looked_ = now;
  std::array<char, 1024> answer{};
  while (::recv(socket_, answer.data(), answer.size(), 0) > 0) {
    silent_ = {};
    answered_ = true;
  }
  if (now - asked_ > kAskEvery) {
    ++number_;
    number_ += number_ == 0 ? 1 : 0;
    const std::array<std::uint8_t, 8> question{kKey,
                                               kAcknowledge,
                                               0,
                                               kDiscovery,
                                               0,
                                               0,
                                               static_cast<std::uint8_t>(number_ >> 8U),
                                               static_cast<std::uint8_t>(number_)};
    [[maybe_unused]] const ssize_t sent = ::send(socket_, question.data(), question.size(), MSG_NOSIGNAL);
    asked_ = now;
  }
  return silent_ > kSilence;
}

}  // namespace dubsar::aravis
