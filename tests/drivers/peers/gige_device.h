// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <netinet/in.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

namespace dubsar::test {

/// A GigE Vision device of our own, without Aravis, on 127.0.0.1: answers GVCP, sends what next() exposes as
/// GVSP packets, loses some of them on request and sends them again when it is asked to.
class GigeDevice {
 public:
  using Bytes = std::vector<std::uint8_t>;

  // Registers of the region, as gige_xml.h and Aravis's fake camera have them.
  static constexpr std::uint32_t kWidthAt = 0x100;
  static constexpr std::uint32_t kHeightAt = 0x104;
  static constexpr std::uint32_t kOffsetXAt = 0x130;
  static constexpr std::uint32_t kOffsetYAt = 0x134;

  /// `xml` is its GenICam description; `loss` the share of packets that are not sent at first.
  GigeDevice(const std::string& model, const std::string& serial, const std::string& xml, double loss);
  virtual ~GigeDevice() = default;
  GigeDevice(const GigeDevice&) = delete;
  GigeDevice& operator=(const GigeDevice&) = delete;

  [[nodiscard]] bool works() const { return works_; }
  void serve_control();
  void serve_stream();
  /// Lets go of whoever has the control, as a camera does that has heard nothing for too long.
  void forget();
  /// As at switching on, but for the registers that stay: nobody has the control, nothing streams, and what
  /// it counts begins anew, its clock too.
  void restart();

  std::atomic<bool> quit = false, quiet = false;
  std::atomic<int> skips = 0;                     ///< so many numbers, before the next frame
  std::atomic<bool> dies_when_taken = false;      ///< the next program that takes control has it for a moment
  std::atomic<std::uint64_t> fell_silent_ns = 0;  ///< of a camera that died so
  /// It obeys whoever has the address of the one in control, as some cameras do, and takes its time to end a
  /// stream.
  std::atomic<bool> lax = false;
  std::atomic<bool> burns_on = false;  ///< it does not obey when its acquisition is to end
  std::atomic<int> resent = 0;

 protected:
  struct Picture {
    Bytes data;
    std::uint64_t timestamp_ns = 0;      ///< of the exposure, CLOCK_MONOTONIC
    std::optional<std::uint32_t> chunk;  ///< an encoder's count, when chunks are on
  };
  /// Waits for the next exposure; `width`, `height` are those of the region. Nothing when none came of it.
  virtual std::optional<Picture> next(std::uint32_t id) = 0;
  virtual void restarted() {}
  /// Whether a register does not take a value as the others stand.
  /// Called, as restarted(), where read() and write() may be used.
  [[nodiscard]] virtual bool refuses(std::uint32_t /*at*/, std::uint32_t /*value*/) const { return false; }

  [[nodiscard]] std::uint32_t reg(std::uint32_t at) {
    const std::lock_guard lock(mutex_);
    return read(at);
  }
  [[nodiscard]] std::uint32_t read(std::uint32_t at) const;
  void write(std::uint32_t at, std::uint32_t value);
  void real(std::uint32_t at, double value);

 private:
  struct Block {
    std::uint16_t id = 0;
    std::vector<Bytes> packets;  ///< leader, payload, trailer; ready to be sent
  };
  void text(std::uint32_t at, const std::string& value);
  void send(const Bytes& packet);
  [[nodiscard]] Block packed(std::uint16_t id, Picture& picture) const;
  void resend(const std::uint8_t* ask);
  void answer(const Bytes& ask, const sockaddr_in& to);
  [[nodiscard]] bool ends_in_vain(std::uint32_t at, std::uint32_t value) const;
  /// Whether it takes its time over this, and answers later.
  bool puts_off(const Bytes& ask, const sockaddr_in& to);

  Bytes memory_;
  double loss_;
  int control_ = -1;
  int stream_ = -1;
  bool works_ = false;
  std::mutex mutex_;
  /// Who has the control channel: writes of anybody else are refused until it is let go or falls silent.
  std::uint64_t controller_ = 0;
  std::uint64_t heard_ns_ = 0;
  std::atomic<std::uint64_t> switched_on_ns_ = 0;  ///< where its clock begins
  struct PutOff {
    Bytes ask;
    sockaddr_in to{};
    std::uint64_t until_ns = 0;
  };
  std::optional<PutOff> put_off_;
  std::deque<Block> history_;
  std::mt19937 random_{1};
};

/// "ready" or "cannot", then both services until standard input ends; each line of it is answered.
int serve_gige(GigeDevice& device);

}  // namespace dubsar::test
