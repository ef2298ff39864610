// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

namespace dubsar {

/// The device for people and archives: `replay:` and `rig:` without the folders of this computer
/// ("replay:/home/anna/scans?unit=m" is "replay:scans?unit=m"), `sim:` with a word that it is none.
[[nodiscard]] std::string told_device(std::string_view uri);

}  // namespace dubsar
