// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// range_peer SERIAL LAW: a range camera (Coord3D_C16) on 127.0.0.1 that a stage carries over a wavy surface
// (range_surface.h): blocks of 16 profiles at 200 profiles a second, each of where the stage, whose law
// stands in the file LAW, was at that time. Commands: resent, quiet.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <thread>

#include "tests/drivers/peers/gige_device.h"
#include "tests/drivers/peers/gige_xml.h"
#include "tests/drivers/peers/range_surface.h"
#include "tests/drivers/peers/stage_law.h"

namespace {

using namespace dubsar::test;

constexpr std::uint32_t kWidth = 160;
constexpr std::uint32_t kRows = 16;
constexpr double kRowS = 0.005;

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

class RangeCamera : public GigeDevice {
 public:
  RangeCamera(const std::string& serial, const SharedLaw& law)
      : GigeDevice("Range 2", serial, range_camera_xml(), 0), law_(law) {
    for (const auto& [address, value] :
         {std::pair(0x11cU, 4096U), std::pair(0x118U, 4096U), std::pair(0x100U, kWidth),
          std::pair(0x104U, kRows), std::pair(0x128U, 0x011000B8U), std::pair(0x138U, 80000U),
          std::pair(0x12cU, 1U)}) {
      write(address, value);
    }
    real(kScales, kSurfacePerColumnMm);
    real(kScales + 8, 0.025);
    real(kScales + 16, kSurfaceDepthMm);
  }

 protected:
  std::optional<Picture> next(std::uint32_t /*id*/) override {
    const double now = now_s();
    due_ = due_ < now - 1 ? now : due_;
    Picture out;
    out.timestamp_ns = static_cast<std::uint64_t>(1e9 * due_);
    for (std::uint32_t row = 0; row < kRows; ++row, due_ += kRowS) {
      std::this_thread::sleep_for(std::chrono::duration<double>(due_ - now_s()));
      const double y = law_.read().at(due_);
      for (std::uint32_t col = 0; col < kWidth; ++col) {
        const auto depth = static_cast<std::uint32_t>(
            std::lround(surface_mm(col * kSurfacePerColumnMm, y) / kSurfaceDepthMm));
        out.data.push_back(static_cast<std::uint8_t>(depth));
        out.data.push_back(static_cast<std::uint8_t>(depth >> 8U));
      }
    }
    return out;
  }

 private:
  const SharedLaw& law_;
  double due_ = 0;
};

}  // namespace

int main(int count, char** words) {
  if (count != 3) {
    std::puts("cannot: range_peer SERIAL LAW");
    return 2;
  }
  const SharedLaw law(words[2]);
  if (!law.works()) {
    std::puts("cannot: no law");
    return 2;
  }
  RangeCamera device(words[1], law);
  return serve_gige(device);
}
