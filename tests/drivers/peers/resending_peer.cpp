// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// resending_peer SERIAL LOSS: a range camera of our own on 127.0.0.1: it loses packets at the ratio LOSS,
// sends them again when it is asked to, and puts the count of an encoder behind each frame (chunk data). Says
// "ready"; commands: resent (packets sent again), quiet (takes no more packets, sends none), forget (who has
// the control), restart (as at switching on), lax (obeys whoever has the address of the one in control), burn
// on (refuses to end its acquisition), obey.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>

#include "tests/drivers/peers/gige_device.h"
#include "tests/drivers/peers/gige_xml.h"

namespace {

constexpr std::uint32_t kChunkMode = 0x2600;
constexpr std::uint32_t kSensorWidth = 320;

std::string description() {
  std::string xml = dubsar::test::range_camera_xml();
  const std::string end = "<Port Name='Device'";
  xml.insert(
      xml.find(end),
      "<Boolean Name='ChunkModeActive' "
      "NameSpace='Standard'><pValue>ChunkModeReg</pValue><OnValue>1</OnValue>"
      "<OffValue>0</OffValue></Boolean>\n<IntReg "
      "Name='ChunkModeReg'><Address>0x2600</Address><Length>4</Length>"
      "<AccessMode>RW</AccessMode><pPort>Device</pPort><Sign>Unsigned</Sign><Endianess>BigEndian</"
      "Endianess>"
      "</IntReg>\n<Integer Name='ChunkEncoderValue' NameSpace='Standard'><pValue>ChunkEncoderReg</pValue>"
      "</Integer>\n<IntReg Name='ChunkEncoderReg'><Address>0</Address><Length>4</Length><AccessMode>RO"
      "</AccessMode><pPort>EncoderChunk</pPort><Cachable>NoCache</Cachable><Sign>Signed</Sign><Endianess>"
      "BigEndian</Endianess></IntReg>\n<Port Name='EncoderChunk'><ChunkID>1001</ChunkID></Port>\n");
  // The announced payload covers the chunks: 4 bytes of encoder, and 8 bytes behind each of the two chunks.
  xml.replace(xml.find("- L</Formula>"), 3, "+ 20");
  return xml;
}

class Resender : public dubsar::test::GigeDevice {
 public:
  Resender(const std::string& serial, double loss) : GigeDevice("Resender", serial, description(), loss) {
    for (const auto& [address, value] :
         {std::pair(0x11cU, kSensorWidth), std::pair(0x118U, 4096U), std::pair(kWidthAt, kSensorWidth),
          std::pair(0x104U, 40U), std::pair(0x128U, 0x011000B8U), std::pair(0x138U, 8000U),
          std::pair(0x12cU, 1U)}) {
      write(address, value);
    }
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      real(dubsar::test::kScales + 8 * axis, 0.1);
    }
  }

 protected:
  void restarted() override {
    encoder_ = 0;
    write(kWidthAt, kSensorWidth);
    write(kOffsetXAt, 0);
  }
  /// A region lies on the sensor.
  [[nodiscard]] bool refuses(std::uint32_t at, std::uint32_t value) const override {
    return (at == kOffsetXAt && value + read(kWidthAt) > kSensorWidth) ||
           (at == kWidthAt && value + read(kOffsetXAt) > kSensorWidth);
  }
  /// Depth 1000 + 3 col, as the other peer paints it; the encoder counts ten for each frame.
  std::optional<Picture> next(std::uint32_t /*id*/) override {
    const auto now = std::chrono::steady_clock::now();
    due_ = due_ < now - std::chrono::milliseconds(100) ? now : due_;
    std::this_thread::sleep_until(due_);
    due_ += std::chrono::microseconds(reg(0x138));
    Picture out;
    out.timestamp_ns = static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                                      std::chrono::steady_clock::now().time_since_epoch())
                                                      .count());
    const std::uint32_t width = reg(kWidthAt);
    const std::uint32_t height = reg(kHeightAt);
    for (std::uint32_t k = 0; k < width * height; ++k) {
      const std::uint32_t depth = 1000 + 3 * (k % width);
      out.data.push_back(static_cast<std::uint8_t>(depth));
      out.data.push_back(static_cast<std::uint8_t>(depth >> 8U));
    }
    encoder_ += 10;
    if (reg(kChunkMode) != 0) {
      out.chunk = encoder_;
    }
    return out;
  }

 private:
  std::chrono::steady_clock::time_point due_{};
  std::atomic<std::uint32_t> encoder_ = 0;
};

}  // namespace

int main(int count, char** words) {
  if (count != 3) {
    std::puts("cannot: resending_peer SERIAL LOSS");
    return 2;
  }
  Resender device(words[1], std::stod(words[2]));
  return dubsar::test::serve_gige(device);
}
