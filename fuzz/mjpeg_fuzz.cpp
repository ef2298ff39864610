// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A picture of motion JPEG from a camera: of the size that it names itself, as far as a camera may.
#include <string>
#include <vector>

#include "drivers/v4l2/mjpeg.h"
#include "fuzz/fuzz_support.h"

namespace {

struct Frame {
  std::uint32_t width, height;
  std::vector<std::uint8_t> pixels = std::vector<std::uint8_t>(std::size_t{width} * height);
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Kept, as a camera's are: to map the larger one anew for each input took nine tenths of the time.
  static std::vector<Frame> frames{{24, 16}, {640, 480}};
  for (Frame& frame : frames) {
    std::string why;
    const bool whole =
        dubsar::v4l2::decode_luma(std::span(data, size), frame.width, frame.height, frame.pixels, why);
    dubsar::fuzz::require(whole == why.empty());
  }
  return 0;
}
