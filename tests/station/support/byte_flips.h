// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/random.h"

namespace dubsar::test {

/// Of one file: how many single bits were turned over, and at which bytes nobody noticed.
struct FlipTally {
  std::uintmax_t bytes = 0;
  std::uintmax_t tried = 0;
  std::uintmax_t idle = 0;               ///< passed, and all that can be read is what it was
  std::vector<std::uintmax_t> missed{};  ///< passed, and something is not
};

/// Whether `dubsar verify` passes a session or a bag: what it answers with status 0.
[[nodiscard]] bool passes_verification(const std::filesystem::path& folder);

/// All that can be read from a session or a bag, as one text: of a database its rows (a page that a log
/// stands in for, and room that is free, hold nothing), of manifests their words (the letters of a checksum
/// may be of either case), of all other files their bytes.
[[nodiscard]] std::string what_it_says(const std::filesystem::path& folder);

/// Turns over one bit of one byte of one file at a time, asks for a verification and puts the byte back. Of a
/// file of at most `per_file` bytes each byte is tried, of a longer one its first and last 64 and others by
/// chance. Left out are the lock and the shared memory of SQLite, which hold nothing that is stored. By name
/// within the folder.
[[nodiscard]] std::map<std::string, FlipTally> flip_bytes(const std::filesystem::path& folder,
                                                          std::uintmax_t per_file, Random& random);

}  // namespace dubsar::test
