// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <future>
#include <utility>

namespace dubsar::ui {

/// Destroys what is large on a thread of its own: giving back hundreds of megabytes takes longer than a frame
/// may. Whoever lets go of the future waits.
template <class Pointer>
[[nodiscard]] std::future<void> give_back(Pointer old) {
  return std::async(std::launch::async, [old = std::move(old)]() mutable { old.reset(); });
}

}  // namespace dubsar::ui
