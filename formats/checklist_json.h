// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

#include "core/checklist.h"
#include "core/result.h"
#include "formats/json_text.h"

namespace dubsar {

/// The keys of docs/formats/checklist.md.
[[nodiscard]] OrderedJson checklist_json(const Checklist& checklist);
[[nodiscard]] std::string checklist_to_json(const Checklist& checklist);

/// The checklist of a session. The sign-off is not read: it is the session's record that has it, and it is
/// held against the session anew. Errors: kBadInput.
[[nodiscard]] Result<Checklist> parse_checklist(std::string_view text, const std::string& where);

}  // namespace dubsar
