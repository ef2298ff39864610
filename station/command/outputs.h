// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

#include "station/command/command.h"

namespace dubsar {

/// The action of a verb that writes these files or folders: kUsage, before it begins, where one of them lies
/// in a session or package or is one (place_outside.h). Empty paths are passed over; links are followed. So,
/// too, where one of them is what the verb reads (`inputs`), or two are the same place.
[[nodiscard]] Action with_safe_outputs(std::vector<std::string> outputs, Action action,
                                       std::vector<std::string> inputs = {});

}  // namespace dubsar
