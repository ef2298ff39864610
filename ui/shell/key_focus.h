// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

namespace dubsar::ui {

/// What can be done by keys with something that is drawn.
enum class Reach {
  kPressed,  ///< enter presses it: a button, a box to tick, a line of a list
  kTyped,    ///< a line that is typed into: it has the cursor as soon as it is reached
  kSlid,     ///< left and right change it
  kNone      ///< nothing: it is pointed at, or only looked at
};

/// Goes by the tab key from each thing that can be pressed to the next in the order in which they are drawn,
/// those of the box that is open alone. ImGui's own navigation (1.86) would take the space key, the enter key
/// and the pedal's page keys for itself, and stops at lines to type in only. Main thread.
class KeyFocus {
 public:
  /// After ImGui has begun a frame, before anything is drawn. `space_scans`: while no box is open the space
  /// key is the station's, as its other keys are, and they take the frame away; else space too presses what
  /// the frame is round.
  void begin(bool space_scans);
  /// The item that was drawn last can be reached. True where the frame is to be drawn round it.
  bool item(Reach reach);
  /// After all is drawn: escape shuts a list that has dropped down.
  void end() const;
  /// Enter is for what the frame is round, and for nothing else.
  [[nodiscard]] bool takes_enter() const;

 private:
  using Id = std::uint32_t;  ///< ImGui's
  struct Stop {
    Id popup = 0;  ///< of the box that it stands in; 0: in none
    Id item = 0;
    Reach reach = Reach::kNone;
  };
  /// What is open over what: each box has a place of its own that is gone back to.
  struct Level {
    Id popup = 0;
    Id item = 0;  ///< where one is; 0: nowhere yet
    bool shown = false;
  };

  void follow_boxes();
  void go(int by);
  void arrive(Id item);
  [[nodiscard]] std::vector<Stop> stops_here() const;

  std::vector<Stop> stops_;  ///< of the last frame that was drawn, in order
  std::vector<Level> levels_{Level{}};
  bool takes_enter_ = false;
  Id arriving_ = 0;  ///< to be scrolled to, and to be typed into where it is a line
  int arriving_frames_ = 0;
  Id list_ = 0;  ///< that was open as the frame began
};

}  // namespace dubsar::ui
