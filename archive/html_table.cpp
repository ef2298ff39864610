// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/html_table.h"

namespace dubsar {

std::string table_row(const std::vector<std::string>& cells, const std::string& row_class) {
  std::string html = row_class.empty() ? "<tr>" : "<tr class=\"" + row_class + "\">";
  for (const std::string& cell : cells) {
    html += "<td>" + cell + "</td>";
  }
  return html + "</tr>\n";
}

std::string html_table(const std::string& table_class, const std::vector<std::string>& names,
                       const std::string& rows) {
  std::string html = "<div class=\"wide\"><table class=\"" + table_class + "\">\n<thead><tr>";
  for (const std::string& name : names) {
    html += "<th scope=\"col\">" + name + "</th>";
  }
  return html + "</tr></thead>\n<tbody>\n" + rows + "</tbody>\n</table></div>\n";
}

std::string dl_entry(const std::string& term, const std::string& value) {
  return value.empty() ? std::string() : "<dt>" + term + "</dt><dd>" + value + "</dd>\n";
}

}  // namespace dubsar
