// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// scanner_peer SERIAL FRAMES LAW LOSS: the camera of a rig on 127.0.0.1. It exposes whenever the stage, whose
// law stands in the file LAW, passes one of the positions of the file FRAMES (scanner_frames.h), stamps the
// frame with that time, and sends what was rendered for it; with the laser off, and where nothing was
// rendered, a dark frame at its own rate; of all frames the region that it is asked for. LOSS is the share of
// packets lost. Commands: resent, quiet.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>
#include <utility>

#include "tests/drivers/peers/gige_device.h"
#include "tests/drivers/peers/gige_xml.h"
#include "tests/drivers/peers/scanner_frames.h"
#include "tests/drivers/peers/stage_law.h"

namespace {

using namespace dubsar::test;

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void sleep_until(double time_s) {
  std::this_thread::sleep_for(std::chrono::duration<double>(time_s - now_s()));
}

class ScannerCamera : public GigeDevice {
 public:
  ScannerCamera(const std::string& serial, const ScannerFrames& frames, const SharedLaw& law, double loss)
      : GigeDevice("Scanner", serial, range_camera_xml(), loss), frames_(frames), law_(law) {
    for (const auto& [address, value] :
         {std::pair(0x11cU, frames.width()), std::pair(0x118U, frames.height()),
          std::pair(kWidthAt, frames.width()), std::pair(kHeightAt, frames.height()),
          std::pair(0x128U, 0x01080001U), std::pair(0x138U, 10000U), std::pair(0x12cU, 1U)}) {
      write(address, value);
    }
  }

 protected:
  [[nodiscard]] bool refuses(std::uint32_t at, std::uint32_t value) const override {
    const auto with = [&](std::uint32_t one) { return one == at ? value : read(one); };
    const bool of_region = at == kWidthAt || at == kHeightAt || at == kOffsetXAt || at == kOffsetYAt;
    return of_region && (with(kWidthAt) == 0 || with(kHeightAt) == 0 ||
                         with(kOffsetXAt) + std::uint64_t{with(kWidthAt)} > frames_.width() ||
                         with(kOffsetYAt) + std::uint64_t{with(kHeightAt)} > frames_.height());
  }
  std::optional<Picture> next(std::uint32_t /*id*/) override {
    const double period = 1e-6 * reg(0x138);
    const StageLaw law = law_.read();
    std::optional<double> soonest;
    std::size_t which = 0;
    for (std::size_t k = 0; k < frames_.count(); ++k) {
      const std::optional<double> when = law.when(frames_.position(k));
      if (when && *when > last_ && (!soonest || *when < *soonest)) {
        soonest = when;
        which = k;
      }
    }
    last_ = std::max(last_, now_s() - 1);
    if (soonest && *soonest < last_ + 2.5 * period) {
      sleep_until(*soonest);
      last_ = *soonest;
      return picture(law_.read().laser > 0 ? frames_.frame(which) : frames_.dark());
    }
    sleep_until(last_ + period);
    last_ = now_s();
    return picture(frames_.dark());
  }

 private:
  [[nodiscard]] Picture picture(std::span<const std::uint8_t> pixels) {
    const std::uint32_t width = reg(kWidthAt);
    const std::uint32_t offset_x = reg(kOffsetXAt);
    const std::uint32_t offset_y = reg(kOffsetYAt);
    const std::uint32_t end = offset_y + reg(kHeightAt);
    Bytes region;
    region.reserve(std::size_t{width} * (end - offset_y));
    for (std::uint32_t row = offset_y; row < end; ++row) {
      const auto part = pixels.subspan(std::size_t{row} * frames_.width() + offset_x, width);
      region.insert(region.end(), part.begin(), part.end());
    }
    return {std::move(region), static_cast<std::uint64_t>(1e9 * last_), std::nullopt};
  }
  const ScannerFrames& frames_;
  const SharedLaw& law_;
  double last_ = 0;  ///< exposure
};

}  // namespace

int main(int count, char** words) {
  if (count != 5) {
    std::puts("cannot: scanner_peer SERIAL FRAMES LAW LOSS");
    return 2;
  }
  const ScannerFrames frames{std::string(words[2])};
  const SharedLaw law(words[3]);
  if (!frames.works() || !law.works()) {
    std::puts("cannot: no frames or no law");
    return 2;
  }
  ScannerCamera device(words[1], frames, law, std::stod(words[4]));
  return serve_gige(device);
}
