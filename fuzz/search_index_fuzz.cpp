// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <xxhash.h>

#include "formats/byte_order.h"
#include "formats/search_index.h"
#include "fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string bytes(dubsar::fuzz::text_of(data, size));
  (void)dubsar::parse_search_index(bytes, "as it is");
  // With the version and the checksum that it ought to have, so that what lies behind them is tried too.
  if (bytes.size() >= 16) {
    bytes.replace(0, 8, dubsar::search_index_to_bytes({}), 0, 8);
    std::string digest;
    dubsar::append(digest, static_cast<std::uint64_t>(XXH64(bytes.data() + 16, bytes.size() - 16, 0)));
    bytes.replace(8, 8, digest);
    if (const auto index = dubsar::parse_search_index(bytes, "with a checksum")) {
      dubsar::fuzz::require(dubsar::search_index_to_bytes(*index) == bytes);
    }
  }
  return 0;
}
