// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/device.h"

namespace dubsar {

/// A driver as a person chooses among them.
struct OfferedDriver {
  std::string scheme;
  std::string description;
  std::string locator_help;          ///< what stands between the colon and '?'; empty when nothing does
  std::vector<SettingInfo> options;  ///< of its URI
  std::vector<std::pair<std::string, std::string>> found;  ///< URI and description of what is plugged in
  std::string trouble;  ///< why nothing could be looked for; empty otherwise
};

/// All drivers with what they find now. Takes as long as the drivers look.
[[nodiscard]] std::vector<OfferedDriver> offered_drivers();

struct UriParts {
  std::string scheme, locator;
  std::vector<std::pair<std::string, std::string>> options;
};
/// Nothing where it is none.
[[nodiscard]] std::optional<UriParts> uri_parts(const std::string& uri);

/// "scheme:locator?key=value&…", with what is empty left out.
[[nodiscard]] std::string compose_uri(const std::string& scheme, const std::string& locator,
                                      const std::vector<std::pair<std::string, std::string>>& options);

}  // namespace dubsar
