// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/artefact_toml.h"
#include "formats/calibration_set.h"
#include "formats/rig_toml.h"
#include "fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = dubsar::fuzz::text_of(data, size);
  if (const auto set = dubsar::parse_calibration_set(text, "calibration.toml")) {
    dubsar::fuzz::require(
        dubsar::parse_calibration_set(dubsar::calibration_set_to_toml(*set), "again").has_value());
  }
  if (const auto artefact = dubsar::parse_artefact(text, "artefact.toml")) {
    dubsar::fuzz::require(!artefact->balls.empty() || artefact->has_plane);
  }
  if (const auto rig = dubsar::parse_rig_file(text, "rig.toml")) {
    dubsar::fuzz::require(rig->rows > 0 && rig->step > 0);
    dubsar::fuzz::require(!rig->motion || rig->motion->direction.norm() > 0);
    dubsar::fuzz::require(!rig->continuous || !rig->ambient);
  }
  return 0;
}
