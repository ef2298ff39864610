// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/rig.h"
#include "formats/json_node.h"
#include "formats/json_text.h"

namespace dubsar {

/// The last verification of a rig as every document has it: `when`, `artefact`, `error_mm`.
[[nodiscard]] OrderedJson json_of(const CalibrationCheck& check);
[[nodiscard]] CalibrationCheck read_calibration_check(const JsonNode& node);

}  // namespace dubsar
