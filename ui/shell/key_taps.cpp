// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/key_taps.h"

namespace dubsar::ui {

void KeyTaps::happened(int key, bool down) {
  if (key < 0 || static_cast<std::size_t>(key) >= kKeys) {
    return;  // one that nothing has a name for
  }
  Key& one = keys_[static_cast<std::size_t>(key)];
  one.is_down = down;
  one.unseen = one.unseen || down;
}

void KeyTaps::put_into(std::span<bool, kKeys> down) {
  for (std::size_t k = 0; k < kKeys; ++k) {
    Key& one = keys_[k];
    if (!one.is_down && !one.unseen && !one.shown) {
      continue;
    }
    const bool show = one.unseen ? !one.shown : one.is_down;
    one.unseen = one.unseen && !show;
    one.shown = down[k] = show;
  }
}

}  // namespace dubsar::ui
