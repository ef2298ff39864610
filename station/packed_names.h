// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

namespace dubsar {

/// What the files of a tablet are called: letters, digits, dot, dash; anything else in its number becomes an
/// underscore. At most 64 characters, none of Windows' names for devices, "tablet" where nothing is left.
[[nodiscard]] std::string file_stem(const std::string& identifier);

/// Names of files for the documents of a session, in their order: "red_map" is "red_map.json", other
/// characters than letters, digits and dashes become underscores. No two are alike, nor would be where a and
/// A are one, nor is any that of the session's events: a second one is "…_2.json". A document whose name
/// needs no change has its own.
[[nodiscard]] std::vector<std::string> document_files(const std::vector<std::string>& names);

}  // namespace dubsar
