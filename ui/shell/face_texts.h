// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "ui/shell/text_table.h"

namespace dubsar::ui {

/// The sides of a tablet by name, and in short, in the order of Face.
inline constexpr Text kFaceTexts[] = {Text::kObverse, Text::kReverse, Text::kLeft,
                                      Text::kRight,   Text::kTop,     Text::kBottom};
inline constexpr Text kShortFaceTexts[] = {Text::kObverseShort, Text::kReverseShort, Text::kLeftShort,
                                           Text::kRightShort,   Text::kTopShort,     Text::kBottomShort};

}  // namespace dubsar::ui
