// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <cmath>

#include "drivers/usb_stage/grbl_protocol.h"
#include "drivers/usb_stage/lines.h"
#include "fuzz/fuzz_support.h"

using namespace dubsar::usb_stage;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  LineSplitter lines;
  const std::string_view text = dubsar::fuzz::text_of(data, size);
  lines.add(text.substr(0, size / 2));  // as the bytes come, so the lines must not care
  lines.add(text.substr(size / 2));
  while (const auto line = lines.next()) {
    dubsar::fuzz::require(!line->empty() && line->size() <= LineSplitter::kLongest);
    const grbl::Line parsed = grbl::parse(*line);
    if (const auto* report = std::get_if<grbl::Report>(&parsed)) {
      dubsar::fuzz::require(report->machine || report->work);
      for (const auto* positions : {&report->machine, &report->work, &report->offset}) {
        for (const double one : positions->value_or(std::vector<double>{})) {
          dubsar::fuzz::require(std::isfinite(one));
        }
      }
    } else if (const auto* fault = std::get_if<grbl::Fault>(&parsed)) {
      dubsar::fuzz::require(!grbl::meaning(*fault).empty());
    }
  }
  return 0;
}
