// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

namespace dubsar {

/// One line of a table; the cells are HTML.
[[nodiscard]] std::string table_row(const std::vector<std::string>& cells, const std::string& row_class = {});

/// A table with a head; `rows` are table_row()s.
[[nodiscard]] std::string html_table(const std::string& table_class, const std::vector<std::string>& names,
                                     const std::string& rows);

/// A term and what it is, for a <dl>. Both are HTML; nothing for an empty value.
[[nodiscard]] std::string dl_entry(const std::string& term, const std::string& value);

}  // namespace dubsar
