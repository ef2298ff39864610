// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "station/command/command.h"

namespace dubsar {

/// Adds hint, lock and unlock to the verb `session`.
void add_session_hints(CLI::App& session, Action& chosen);
/// Adds mesh.
void add_session_mesh(CLI::App& session, Action& chosen);
/// Adds sign.
void add_session_sign(CLI::App& session, Action& chosen);

}  // namespace dubsar
