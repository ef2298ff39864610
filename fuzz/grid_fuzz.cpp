// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <xxhash.h>

#include <span>
#include <vector>

#include "formats/byte_order.h"
#include "formats/grid_file.h"
#include "formats/grid_header.h"
#include "fuzz/fuzz_support.h"

/// Sets the file's length and checksum right first: behind them is where a reader could go wrong.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string file(reinterpret_cast<const char*>(data), size);
  (void)dubsar::decode_grid(std::as_bytes(std::span(file)), "as it is");
  if (file.size() < dubsar::kGridPreludeBytes + dubsar::kGridChecksumBytes) {
    return 0;
  }
  std::string length;
  dubsar::append(length, std::uint64_t{file.size()});
  file.replace(16, length.size(), length);
  file.resize(file.size() - dubsar::kGridChecksumBytes);
  dubsar::append(file, std::uint64_t{XXH64(file.data(), file.size(), 0)});
  if (const auto grid = dubsar::decode_grid(std::as_bytes(std::span(file)), "mended")) {
    dubsar::fuzz::check_grid(*grid);
    const auto again = dubsar::decode_grid(dubsar::encode_grid(*grid), "again");
    dubsar::fuzz::require(again && again->valid == grid->valid);
  }
  return 0;
}
