// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/gray_file.h"
#include "fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (const auto image = dubsar::parse_gray(dubsar::fuzz::text_of(data, size), "picture")) {
    dubsar::fuzz::require(image->width > 0 && image->height > 0 &&
                          image->pixels.size() == static_cast<std::size_t>(image->width) *
                                                      static_cast<std::size_t>(image->height));
  }
  return 0;
}
