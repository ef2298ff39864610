// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "station/command/command.h"

namespace dubsar {

/// `dubsar simulate rig`, under the verb `simulate`.
void add_simulate_rig(CLI::App& simulate, Action& chosen);

}  // namespace dubsar
