// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

/// What the program has synced. The source file replaces the C library's fsync(): it belongs to the sources
/// of each test program that looks.
namespace dubsar::test {

void forget_syncs();
/// Since then, of a file or folder that is still there.
[[nodiscard]] bool was_synced(const std::filesystem::path& path);

}  // namespace dubsar::test
