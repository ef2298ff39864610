// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

namespace dubsar {

/// The first address (http or https) in a sentence about rights, such as "CC BY 4.0
/// (https://creativecommons.org/licenses/by/4.0/)"; empty where it holds none.
[[nodiscard]] std::string rights_address(std::string_view rights);

/// The same where IIIF Presentation 3.0 takes it for `rights`: an address of Creative Commons or
/// RightsStatements.org, which both name their texts with http. Empty otherwise.
[[nodiscard]] std::string iiif_rights(std::string_view rights);

}  // namespace dubsar
