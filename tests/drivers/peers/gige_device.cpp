// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "tests/drivers/peers/gige_device.h"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <thread>

#include "core/thread_priority.h"
#include "tests/drivers/peers/device_thread.h"

namespace dubsar::test {

namespace {

using Bytes = GigeDevice::Bytes;
using namespace std::chrono_literals;

constexpr std::uint32_t kXmlAt = 0x10000;
constexpr std::uint32_t kEncoderChunk = 0x1001;
constexpr std::uint32_t kHeartbeat_ms = 0x938;
constexpr std::uint32_t kControlPrivilege = 0xa00;
constexpr std::uint32_t kInvalidParameter = 0x8002;
constexpr std::uint32_t kAccessDenied = 0x8006;
constexpr std::uint32_t kStreamPort = 0xd00;
constexpr std::uint32_t kAcquisition = 0x124;
constexpr std::uint32_t kTimestampControl = 0x944;
constexpr std::uint32_t kTimestampLatched = 0x948;

void put16(Bytes& to, std::uint32_t value) {
  to.push_back(static_cast<std::uint8_t>(value >> 8U));
  to.push_back(static_cast<std::uint8_t>(value));
}
void put32(Bytes& to, std::uint32_t value) {
  put16(to, value >> 16U);
  put16(to, value);
}

std::uint64_t now_ns() {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                        std::chrono::steady_clock::now().time_since_epoch())
                                        .count());
}

}  // namespace

GigeDevice::GigeDevice(const std::string& model, const std::string& serial, const std::string& xml,
                       double loss)
    : memory_(kXmlAt), loss_(loss) {
  write(0x0, 0x00010002);  // GigE Vision 1.2
  write(0x4, 0x80000001);  // big-endian, UTF-8
  write(0x24, INADDR_LOOPBACK);
  text(0x48, "Dubsar");
  text(0x68, model);
  text(0xd8, serial);
  char url[64];
  std::snprintf(url, sizeof url, "Local:camera.xml;%x;%zx", kXmlAt, xml.size());
  text(0x200, url);
  write(0x904, 1);    // stream channels
  write(0x934, 0x4);  // it can resend
  write(kHeartbeat_ms, 3000);
  write(0x93c, 0);
  write(0x940, 1000000000);
  write(0xd04, 1400);
  memory_.insert(memory_.end(), xml.begin(), xml.end());
  memory_.resize(memory_.size() + 1024);
  control_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  stream_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_port = htons(3956);
  here.sin_addr.s_addr = htonl(INADDR_ANY);
  works_ = ::bind(control_, reinterpret_cast<sockaddr*>(&here), sizeof here) == 0;
}

std::uint32_t GigeDevice::read(std::uint32_t at) const {
  return std::uint32_t{memory_[at]} << 24U | std::uint32_t{memory_[at + 1]} << 16U |
         std::uint32_t{memory_[at + 2]} << 8U | memory_[at + 3];
}

void GigeDevice::write(std::uint32_t at, std::uint32_t value) {
  for (std::uint32_t k = 0; k < 4; ++k) {
    memory_[at + k] = static_cast<std::uint8_t>(value >> (24 - 8 * k));
  }
}

void GigeDevice::real(std::uint32_t at, double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  write(at, static_cast<std::uint32_t>(bits >> 32U));
  write(at + 4, static_cast<std::uint32_t>(bits));
}

void GigeDevice::text(std::uint32_t at, const std::string& value) {
  std::ranges::copy(value, memory_.begin() + at);
}

void GigeDevice::serve_control() {
  prefer_this_thread();
  while (!quit) {
    pollfd waiting{control_, POLLIN, 0};
    std::uint8_t bytes[2048];
    sockaddr_in from{};
    socklen_t length = sizeof from;
    const bool heard = ::poll(&waiting, 1, 50) > 0;
    if (put_off_ && now_ns() > put_off_->until_ns) {
      answer(put_off_->ask, put_off_->to);
      put_off_.reset();
    }
    if (!heard) {
      continue;
    }
    const ssize_t got =
        ::recvfrom(control_, bytes, sizeof bytes, 0, reinterpret_cast<sockaddr*>(&from), &length);
    if (const Bytes ask(bytes, bytes + std::max<ssize_t>(got, 0));
        got >= 8 && bytes[0] == 0x42 && !quiet && !puts_off(ask, from)) {
      answer(ask, from);
    }
  }
}

bool GigeDevice::puts_off(const Bytes& ask, const sockaddr_in& to) {
  // WRITEREG of the stream's port to 0.
  const Bytes end{0x00, 0x82, 0, 8};
  const Bytes port{0, 0, kStreamPort >> 8U, kStreamPort & 0xffU, 0, 0, 0, 0};
  if (!lax || ask.size() < 16 || !std::equal(end.begin(), end.end(), ask.begin() + 2) ||
      !std::equal(port.begin(), port.end(), ask.begin() + 8)) {
    return false;
  }
  if (!put_off_) {
    put_off_ = PutOff{ask, to, now_ns() + 300'000'000};
  }
  return true;
}

void GigeDevice::serve_stream() {
  become_device_thread();
  std::uint16_t id = 0;
  while (!quit) {
    bool on = false;
    {
      const std::lock_guard lock(mutex_);
      on = read(kAcquisition) == 1 && read(kStreamPort) != 0 && !quiet;
    }
    if (!on) {
      id = 0;
      std::this_thread::sleep_for(1ms);
      continue;
    }
    const auto wanted = static_cast<std::uint16_t>(1 + (id + skips.exchange(0)) % 65535);
    std::optional<Picture> picture = next(wanted);
    if (!picture) {
      continue;
    }
    id = wanted;
    std::vector<Bytes> packets;
    {
      const std::lock_guard lock(mutex_);
      if (history_.size() > 8) {
        history_.pop_front();
      }
      history_.push_back(packed(id, *picture));
      packets = history_.back().packets;
    }
    for (const Bytes& packet : packets) {
      if (std::uniform_real_distribution<>(0, 1)(random_) >= loss_) {
        send(packet);
      }
    }
  }
}

void GigeDevice::send(const Bytes& packet) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(read(kStreamPort)));
  to.sin_addr.s_addr = htonl(read(0xd18));
  ::sendto(stream_, packet.data(), packet.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof to);
}

GigeDevice::Block GigeDevice::packed(std::uint16_t id, Picture& picture) const {
  Bytes& data = picture.data;
  const bool chunks = picture.chunk.has_value();
  const std::uint32_t width = read(kWidthAt);
  const std::uint32_t height = read(kHeightAt);
  if (chunks) {
    const auto size = static_cast<std::uint32_t>(data.size());
    put32(data, 1);
    put32(data, size);
    put32(data, *picture.chunk);
    put32(data, kEncoderChunk);
    put32(data, 4);
  }
  const std::uint32_t room = (read(0xd04) & 0xffffU) - 36;
  const std::uint32_t type = chunks ? 0x4001 : 0x0001;
  Block out{id, {}};
  const auto begin = [&](std::uint32_t kind) {
    Bytes packet;
    put16(packet, 0);
    put16(packet, id);
    put32(packet, kind << 24U | static_cast<std::uint32_t>(out.packets.size()));
    return packet;
  };
  Bytes leader = begin(1);
  put16(leader, 0);
  put16(leader, type);
  const std::uint64_t stamp_ns = picture.timestamp_ns - switched_on_ns_;
  put32(leader, static_cast<std::uint32_t>(stamp_ns >> 32U));
  put32(leader, static_cast<std::uint32_t>(stamp_ns));
  for (const std::uint32_t word : {read(0x128), width, height, read(kOffsetXAt), read(kOffsetYAt), 0U}) {
    put32(leader, word);
  }
  out.packets.push_back(leader);
  for (std::size_t at = 0; at < data.size(); at += room) {
    Bytes packet = begin(3);
    packet.insert(packet.end(), data.begin() + static_cast<std::ptrdiff_t>(at),
                  data.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(at + room, data.size())));
    out.packets.push_back(packet);
  }
  Bytes trailer = begin(2);
  put16(trailer, 0);
  put16(trailer, type);
  put32(trailer, height);
  out.packets.push_back(trailer);
  return out;
}

void GigeDevice::resend(const std::uint8_t* ask) {
  const auto id = static_cast<std::uint16_t>(ask[2] << 8U | ask[3]);
  const std::uint32_t first = (std::uint32_t{ask[5]} << 16U | std::uint32_t{ask[6]} << 8U | ask[7]);
  const std::uint32_t last = (std::uint32_t{ask[9]} << 16U | std::uint32_t{ask[10]} << 8U | ask[11]);
  for (const Block& block : history_) {
    for (std::uint32_t k = first; block.id == id && k <= last && k < block.packets.size(); ++k) {
      send(block.packets[k]);
      ++resent;
    }
  }
}

void GigeDevice::answer(const Bytes& ask, const sockaddr_in& to) {
  const std::uint32_t command = std::uint32_t{ask[2]} << 8U | ask[3];
  const std::uint8_t* body = ask.data() + 8;
  const std::size_t size = ask.size() - 8;
  const std::lock_guard lock(mutex_);
  Bytes data;
  const auto word = [&](std::size_t at) {
    return std::uint32_t{body[at]} << 24U | std::uint32_t{body[at + 1]} << 16U |
           std::uint32_t{body[at + 2]} << 8U | body[at + 3];
  };
  std::uint32_t status = 0;
  // One application has the control, by address and port; what is left of another one may not take it away.
  const std::uint64_t who = std::uint64_t{to.sin_addr.s_addr} << 16U | to.sin_port;
  const std::uint64_t now = now_ns();
  if (controller_ != 0 &&
      (read(kControlPrivilege) == 0 || now - heard_ns_ > std::uint64_t{read(kHeartbeat_ms)} * 1'000'000)) {
    controller_ = 0;
    write(kControlPrivilege, 0);
  }
  heard_ns_ = who == controller_ ? now : heard_ns_;
  const bool may_write = who == controller_ || (lax && who >> 16U == controller_ >> 16U) ||
                         (controller_ == 0 && command == 0x0082 && size >= 8 && word(0) == kControlPrivilege);
  switch (command) {
    case 0x0002:  // discovery: what stands at the start of the registers
      data.assign(memory_.begin(), memory_.begin() + 0xf8);
      break;
    case 0x0080:
      for (std::size_t k = 0; k + 4 <= size; k += 4) {
        put32(data, word(k) + 4 <= memory_.size() ? read(word(k)) : 0);
      }
      break;
    case 0x0082:
      if (!may_write) {
        status = kAccessDenied;
        break;
      }
      for (std::size_t k = 0; k + 8 <= size; k += 8) {
        if (refuses(word(k), word(k + 4)) || ends_in_vain(word(k), word(k + 4))) {
          status = kInvalidParameter;
          break;
        }
        if (word(k) + 4 <= kXmlAt) {
          write(word(k), word(k + 4));
        }
        if (word(k) == kControlPrivilege && word(k + 4) != 0) {
          controller_ = who;
          heard_ns_ = now;
          if (dies_when_taken) {
            fell_silent_ns = now;
            quiet = true;
          }
        }
        if (word(k) == kTimestampControl && (word(k + 4) & 2U) != 0) {
          write(kTimestampLatched, static_cast<std::uint32_t>((now - switched_on_ns_) >> 32U));
          write(kTimestampLatched + 4, static_cast<std::uint32_t>(now - switched_on_ns_));
        }
      }
      put32(data, 1);
      break;
    case 0x0084: {
      const std::uint32_t at = word(0);
      const std::uint32_t count = word(4) & 0xffffU;
      put32(data, at);
      if (at + count <= memory_.size()) {
        data.insert(data.end(), memory_.begin() + at, memory_.begin() + at + count);
      } else {
        status = 0x8003;
      }
      break;
    }
    case 0x0086:
      if (!may_write) {
        status = kAccessDenied;
        break;
      }
      if (size == 8 && (refuses(word(0), word(4)) || ends_in_vain(word(0), word(4)))) {
        status = kInvalidParameter;
        break;
      }
      for (std::size_t k = 4; k < size && word(0) + k - 4 < kXmlAt; ++k) {
        memory_[word(0) + k - 4] = body[k];
      }
      put32(data, word(0));
      break;
    case 0x0040:
      resend(body);
      return;
    default:
      status = 0x8001;
  }
  Bytes out;
  put16(out, status);
  put16(out, command + 1);
  put16(out, static_cast<std::uint32_t>(data.size()));
  out.push_back(ask[6]);
  out.push_back(ask[7]);
  out.insert(out.end(), data.begin(), data.end());
  ::sendto(control_, out.data(), out.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
}

bool GigeDevice::ends_in_vain(std::uint32_t at, std::uint32_t value) const {
  return burns_on && at == kAcquisition && value == 0;
}

void GigeDevice::forget() {
  const std::lock_guard lock(mutex_);
  controller_ = 0;
  write(kControlPrivilege, 0);
  write(kStreamPort, 0);  // as the standard has it: the stream ends with the control
}

void GigeDevice::restart() {
  forget();
  const std::lock_guard lock(mutex_);
  write(kAcquisition, 0);
  switched_on_ns_ = now_ns();
  restarted();
}

int serve_gige(GigeDevice& device) {
  if (!device.works()) {
    std::puts("cannot: the port of GigE Vision is taken");
    return 2;
  }
  std::puts("ready");
  std::fflush(stdout);
  std::jthread control([&] { device.serve_control(); });
  std::jthread stream([&] { device.serve_stream(); });
  for (std::string line; std::getline(std::cin, line);) {
    if (line == "forget") {
      device.forget();
    }
    if (line == "lax") {
      device.lax = true;
    }
    if (line == "burn on" || line == "obey") {
      device.burns_on = line == "burn on";
    }
    if (line == "restart") {
      device.restart();
    }
    if (line == "skip 1000") {
      device.skips = 1000;
    }
    if (line == "quiet") {
      device.quiet = true;
    }
    if (line == "forget and die when taken") {
      device.dies_when_taken = true;
      device.forget();
    }
    if (line == "silent ms") {
      const std::uint64_t since = device.fell_silent_ns;
      std::cout << (since == 0 ? 0 : (now_ns() - since) / 1'000'000) << std::endl;
      continue;
    }
    std::cout << (line == "resent" ? std::to_string(device.resent.load()) : "ok") << std::endl;
  }
  device.quit = true;
  return 0;
}

}  // namespace dubsar::test
