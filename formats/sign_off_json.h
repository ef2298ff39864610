// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "core/sign_off.h"
#include "formats/json_text.h"

namespace dubsar {

/// The keys of docs/formats/sign_off.md, without the manifest.
[[nodiscard]] OrderedJson sign_off_json(const SignOff& sign_off);
/// With "holds" and "changed" beside them.
[[nodiscard]] OrderedJson sign_off_json(const CheckedSignOff& checked);

/// A sign-off as the session's record keeps it, with the manifest that was signed.
struct RecordedSignOff {
  SignOff sign_off;
  std::string manifest;
};
[[nodiscard]] std::string recorded_sign_off_to_json(const RecordedSignOff& recorded);
[[nodiscard]] Result<RecordedSignOff> parse_recorded_sign_off(std::string_view text,
                                                              const std::string& where);

}  // namespace dubsar
