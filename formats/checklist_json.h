// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

#include "core/checklist.h"
#include "core/result.h"

namespace dubsar {

/// What an operator signs: coverage by face, counts of scans, calibration, disk and integrity.
[[nodiscard]] std::string checklist_to_json(const Checklist& checklist);
[[nodiscard]] Result<Checklist> parse_checklist(std::string_view text, const std::string& where);

}  // namespace dubsar
