// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/command/outputs.h"

#include <utility>

#include "station/place_outside.h"

namespace dubsar {

Action outside_sessions(std::vector<std::string> outputs, Action action) {
  return [outputs = std::move(outputs), action = std::move(action)](CommandContext& context) -> Result<int> {
    for (const std::string& output : outputs) {
      if (const Status outside = output.empty() ? Status() : check_outside_sessions(output); !outside) {
        return std::unexpected(outside.error());
      }
    }
    return action(context);
  };
}

}  // namespace dubsar
