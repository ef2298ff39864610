// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/calibration_json.h"
#include "formats/verification_log.h"
#include "fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = dubsar::fuzz::text_of(data, size);
  if (const auto calibration = dubsar::parse_calibration(text, "calibration.json")) {
    dubsar::fuzz::require(calibration->camera.undistort({0, 0}).has_value());
    dubsar::fuzz::require(
        dubsar::parse_calibration(dubsar::calibration_to_json(*calibration), "again").has_value());
  }
  for (const dubsar::VerificationEntry& entry : dubsar::parse_verification_log(text).entries) {
    dubsar::fuzz::require(entry.error_mm >= 0);
  }
  return 0;
}
