// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

#include "core/wedge.h"
#include "formats/file_label.h"

namespace dubsar {

/// The wedges as a table for spreadsheets and statistics: CSV (RFC 4180) with a line of names first, one line
/// a wedge, a point as decimal sign whatever the locale. Lengths in mm, angles in degrees, positions in the
/// model's frame; the names say so. What is not known is empty. Each line tells at its end what the wedge is
/// of, so that it can be known in a spreadsheet, among the wedges of other tablets too.
[[nodiscard]] std::string wedge_table(const std::vector<Wedge>& wedges, const FileLabel& label);

}  // namespace dubsar
