// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

namespace dubsar::ui {

/// Whether the graphics card has refused memory (GL_OUT_OF_MEMORY) since this was asked last. Main thread.
[[nodiscard]] bool card_has_refused();

}  // namespace dubsar::ui
