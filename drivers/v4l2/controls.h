// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "drivers/driver.h"
#include "drivers/v4l2/node.h"

namespace dubsar::v4l2 {

/// A control of a camera as a typed setting.
struct Control {
  std::string key;
  std::string help;
  std::string unit;
  std::uint32_t id = 0;
  dubsar_type type = DUBSAR_TYPE_INTEGER;
  std::uint32_t flags = 0;  ///< DUBSAR_SETTING_*
  double minimum = 0;
  double maximum = 0;
  double step = 0;
  double unit_per_count = 1;  ///< the setting's value of one count of the control
  std::vector<std::pair<std::string, std::int32_t>> choices;

  /// For dubsar_setting.
  [[nodiscard]] std::string choice_words() const;
  [[nodiscard]] bool is_number() const { return type == DUBSAR_TYPE_INTEGER || type == DUBSAR_TYPE_NUMBER; }
};

/// The controls that a camera has, exposure and gain under the keys that all cameras share; others under
/// their own names in lower case. Buttons, texts and 64-bit controls are left out.
[[nodiscard]] std::vector<Control> controls_of(const Node& node);

[[nodiscard]] Result<dubsar_value> read_control(const Node& node, const Control& control);
/// Setting exposure or gain ends the camera's own automatic of it first. The value has the control's type.
/// kUsage for a value that the camera refuses, and for a control that another one puts out of use.
Status write_control(const Node& node, const Control& control, const dubsar_value& value);
/// A lens that focuses by itself has another focal length than it was calibrated with: ends that where it is
/// on. kUsage, kDevice: the camera refuses.
Status end_autofocus(const Node& node);
/// The control (of exposure or gain) whose value the camera sets by itself once this one has this value.
[[nodiscard]] std::optional<std::uint32_t> left_to_camera(const Node& node, const Control& control,
                                                          const dubsar_value& value);
/// Sets what was set in the camera before, by the controls' ids: first what says who sets the numbers, then
/// these, but for those that are out of use.
Status write_again(const Node& node, std::span<const Control> controls,
                   const std::map<std::uint32_t, dubsar_value>& values);

/// "Gain, Automatic" -> "gain_automatic".
[[nodiscard]] std::string key_from(const std::string& name);

}  // namespace dubsar::v4l2
