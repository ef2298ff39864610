// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

namespace dubsar {

/// The first address (http or https) in a sentence about rights, such as "CC BY 4.0
/// (https://creativecommons.org/licenses/by/4.0/)"; empty where it holds none.
[[nodiscard]] std::string rights_address(std::string_view rights);

/// The same where IIIF Presentation 3.0 takes it for `rights`: a licence or a mark of Creative Commons, or a
/// statement of RightsStatements.org, which both name them with http and a slash at the end. The page that
/// shows one to people ("https://rightsstatements.org/page/InC/1.0/?language=en",
/// "https://creativecommons.org/licenses/by/4.0/deed.en") gives its own address
/// ("http://rightsstatements.org/vocab/InC/1.0/", "http://creativecommons.org/licenses/by/4.0/"). Empty
/// otherwise.
[[nodiscard]] std::string iiif_rights(std::string_view rights);

}  // namespace dubsar
