// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "station/command/command.h"

namespace dubsar {

/// Options of `dubsar calibrate --verify`.
struct VerifyOptions {
  std::string artefact;     ///< artefact.toml
  std::string calibration;  ///< whose log it goes into
  std::string unit;
  [[nodiscard]] bool wanted() const { return !artefact.empty(); }
};
void add_verify_options(CLI::App& verb, VerifyOptions& options);
/// Measures the artefact in a scan, prints and logs the outcome.
[[nodiscard]] Result<int> verify_rig(const VerifyOptions& options, const std::string& scan, CommandContext& context);

}  // namespace dubsar
