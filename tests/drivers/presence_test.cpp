// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/aravis/presence.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <thread>

namespace dubsar::aravis {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kHere = 0x7f000d01;  // 127.0.13.1: nobody else's

/// A camera as far as Presence asks: it answers questions while it is awake.
class Answering {
 public:
  Answering() : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_port = htons(3956);
    here.sin_addr.s_addr = htonl(kHere);
    works = ::bind(socket_, reinterpret_cast<const sockaddr*>(&here), sizeof here) == 0;
    thread_ = std::jthread([this](const std::stop_token& enough) {
      while (!enough.stop_requested()) {
        pollfd waiting{socket_, POLLIN, 0};
        char bytes[256];
        sockaddr_in from{};
        socklen_t length = sizeof from;
        if (::poll(&waiting, 1, 10) > 0 &&
            ::recvfrom(socket_, bytes, sizeof bytes, 0, reinterpret_cast<sockaddr*>(&from), &length) > 0 &&
            awake) {
          ::sendto(socket_, bytes, 8, 0, reinterpret_cast<const sockaddr*>(&from), length);
        }
      }
    });
  }
  ~Answering() {
    thread_ = {};
    ::close(socket_);
  }
  Answering(const Answering&) = delete;
  Answering& operator=(const Answering&) = delete;
  bool works = false;
  std::atomic<bool> awake = true;

 private:
  int socket_;
  std::jthread thread_;
};

TEST(Presence, AMachineThatStoodStillIsNoCameraThatIsGone) {
  Answering camera;
  if (!camera.works) {
    GTEST_SKIP() << "the port of GigE Vision is taken";
  }
  Presence presence(htonl(kHere));
  // Its frames come, so that nobody asks; then nobody looks; then again, with a question on its way.
  presence.quiet();
  for (int k = 0; k < 2; ++k) {
    std::this_thread::sleep_for(Presence::kSilence + 300ms);
    EXPECT_FALSE(presence.gone());
  }
  camera.awake = false;
  const auto start = std::chrono::steady_clock::now();
  while (!presence.gone() && std::chrono::steady_clock::now() - start < 20s) {
    std::this_thread::sleep_for(50ms);
  }
  EXPECT_TRUE(presence.gone());
  EXPECT_TRUE(presence.is_doubtful());
  camera.awake = true;
  EXPECT_FALSE([&] {
    for (int k = 0; k < 100 && presence.gone(); ++k) {
      std::this_thread::sleep_for(50ms);
    }
    return presence.gone();
  }());
}

}  // namespace
}  // namespace dubsar::aravis
