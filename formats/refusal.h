// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/result.h"

namespace dubsar {

/// What helps where the system refuses a file or a folder with this errno; `otherwise` where the number alone
/// does not tell.
[[nodiscard]] std::string mend_of_refusal(int error, std::string_view otherwise);

/// kStorage: "DOING: why", at that place, with that mend.
[[nodiscard]] std::unexpected<Error> refused(const std::filesystem::path& path, std::string_view doing,
                                             int error, std::string_view otherwise);

}  // namespace dubsar
