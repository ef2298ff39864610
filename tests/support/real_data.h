// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdlib>
#include <filesystem>

#include "build_paths.h"

namespace dubsar::test {

/// The folder of real scans: $DUBSAR_DATA, or ../shared/data beside the sources. It may not be there.
inline std::filesystem::path real_data() {
  const char* named = std::getenv("DUBSAR_DATA");
  return named != nullptr ? std::filesystem::path(named)
                          : std::filesystem::path(DUBSAR_SOURCE_DIR) / ".." / "shared" / "data";
}

}  // namespace dubsar::test
