// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>

#include "formats/atomic_file.h"

namespace dubsar {

/// Whether two files can be read, are no longer than that, and hold the same.
[[nodiscard]] bool have_same_bytes(const std::filesystem::path& a, const std::filesystem::path& b,
                                   std::uint64_t limit_bytes = kMaxFileBytes);

}  // namespace dubsar
