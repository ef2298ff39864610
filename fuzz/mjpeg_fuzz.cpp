// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A picture of motion JPEG from a camera: of the size that it names itself, as far as a camera may.
#include <string>
#include <vector>

#include "drivers/v4l2/mjpeg.h"
#include "fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span picture(data, size);
  for (const auto& [width, height] : {std::pair(24U, 16U), std::pair(640U, 480U)}) {
    std::vector<std::uint8_t> pixels(std::size_t{width} * height);
    std::string why;
    const bool whole = dubsar::v4l2::decode_luma(picture, width, height, pixels, why);
    dubsar::fuzz::require(whole == why.empty());
  }
  return 0;
}
