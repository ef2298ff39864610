// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/pin_set.h"
#include "core/result.h"

namespace dubsar {

/// The pins file of `scan` and `register` (docs/formats/pins.md): centres of the tip balls in each scan's
/// frame.
[[nodiscard]] std::string pins_to_json(const PinSet& pins);
[[nodiscard]] Status write_pins(const std::filesystem::path& path, const PinSet& pins);

/// `tip_diameter_mm` must be there; no `scans` means unlabelled pins; a tip without a `label` has -1.
[[nodiscard]] Result<PinSet> parse_pins(std::string_view text, const std::string& where);
[[nodiscard]] Result<PinSet> read_pins(const std::filesystem::path& path);

}  // namespace dubsar
