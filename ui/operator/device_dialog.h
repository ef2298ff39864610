// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <future>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "station/offered_devices.h"
#include "ui/shell/widgets.h"

namespace dubsar::ui {

/// Which scanner, and how it is set: made of what the drivers say of themselves.
class DeviceDialog {
 public:
  void open(const std::string& current_uri);
  /// The URI that was chosen, in the frame that it was chosen in.
  std::optional<std::string> draw(UiContext& ui);

 private:
  void look();
  void take(const std::string& uri);
  void draw_choices(UiContext& ui);
  void draw_options(UiContext& ui);
  std::future<std::vector<OfferedDriver>> looking_;
  std::vector<OfferedDriver> drivers_;
  bool known_ = false;
  bool open_ = false;
  std::size_t chosen_ = 0;  ///< of drivers_; past its end: none
  std::string locator_;
  std::map<std::string, std::string> values_;  ///< by option
  std::string uri_;
};

}  // namespace dubsar::ui
