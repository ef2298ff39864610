// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

#include "core/wedge.h"

namespace dubsar {

/// The wedges as a table for spreadsheets and statistics: CSV (RFC 4180) with a line of names first, one line
/// a wedge, a point as decimal sign whatever the locale. Lengths in mm, angles in degrees, positions in the
/// model's frame; the names say so. What is not known is empty.
[[nodiscard]] std::string wedge_table(const std::vector<Wedge>& wedges);

}  // namespace dubsar
