// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

namespace dubsar {

/// Text that decides how a tablet lies has to lead the next best reading by this (TextFrame::certainty).
inline constexpr double kCertainText = 0.1;

}  // namespace dubsar
