// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace dubsar::ui {

/// Keys that go down and up again between two frames. ImGui's back end (1.86) knows only how a key stands
/// when a frame begins: a foot pedal's pulse, or a tap on the emergency stop while the machine has much to
/// do, would be none.
class KeyTaps {
 public:
  static constexpr std::size_t kKeys = 512;  ///< as many as ImGui has

  /// A key of the keyboard, from the window's own callback. Repeats are none.
  void happened(int key, bool down);
  /// Before a frame: each press since the last one is seen once, in a frame before which the key was up.
  void put_into(std::span<bool, kKeys> down);

 private:
  struct Key {
    bool is_down = false;
    bool unseen = false;  ///< pressed since a frame last showed it
    bool shown = false;   ///< down in the last frame
  };
  std::array<Key, kKeys> keys_;
};

}  // namespace dubsar::ui
