// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

namespace dubsar {

/// What the files of a tablet are called: letters, digits, dot, dash; anything else in its number becomes an
/// underscore. At most 64 characters, none of Windows' names for devices. Where nothing is left of the number
/// it is the same of the session's name, and "tablet" where nothing is left of that either.
[[nodiscard]] std::string file_stem(const std::string& identifier, const std::string& session);

/// What a tablet is called in the addresses of a package that nobody serves yet (RFC 3986, 3.3): no two
/// numbers are called alike. A number of letters, digits, dots, dashes and single blanks is as in
/// file_stem(), "BM_12345", and so is the name of a session, underscores and all; anything else is
/// percent-encoded, and a number that is too long for an address ends in a digest of it.
[[nodiscard]] std::string address_name(const std::string& identifier, bool is_name_of_session);

/// Names of files for the documents of a session, in their order: "red_map" is "red_map.json", other
/// characters than letters, digits and dashes become underscores. No two are alike, nor would be where a and
/// A are one, nor is any that of the session's events: a second one is "…_2.json". A document whose name
/// needs no change has its own.
[[nodiscard]] std::vector<std::string> document_files(const std::vector<std::string>& names);

}  // namespace dubsar
