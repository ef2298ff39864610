// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <cmath>

#include "drivers/usb_stage/horus_protocol.h"
#include "drivers/usb_stage/lines.h"
#include "fuzz/fuzz_support.h"

using namespace dubsar::usb_stage;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  LineSplitter lines;
  lines.add(dubsar::fuzz::text_of(data, size));
  while (const auto line = lines.next()) {
    const horus::Line parsed = horus::parse(*line);
    if (const auto* report = std::get_if<horus::Report>(&parsed)) {
      dubsar::fuzz::require(std::isfinite(report->degrees));
      dubsar::fuzz::require(!(report->moving && report->alarm));
    }
  }
  return 0;
}
