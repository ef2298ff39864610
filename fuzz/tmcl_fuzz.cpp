// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/usb_stage/tmcl_protocol.h"
#include "fuzz/fuzz_support.h"

using namespace dubsar::usb_stage;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(data, size);
  tmcl::ReplyFinder whole(tmcl::Command::kGetAxis);
  const auto found = whole.add(bytes);
  // Whether the bytes come at once or one by one is all the same.
  tmcl::ReplyFinder single(tmcl::Command::kGetAxis);
  std::optional<tmcl::Reply> later;
  for (std::size_t k = 0; k < size && !later; ++k) {
    later = single.add(bytes.subspan(k, 1));
  }
  dubsar::fuzz::require(found.has_value() == later.has_value());
  if (found) {
    dubsar::fuzz::require(found->value == later->value && found->status == later->status);
    dubsar::fuzz::require(!tmcl::meaning(found->status).empty());
  }
  return 0;
}
