// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/html.h"
#include "archive/report_sections.h"

namespace dubsar {

Result<std::string> checklist_html(const ReportInput& input, const ReportPictures& pictures) {
  std::string html = page_head(input, "checklist", "Checklist");
  html += verdict_section(input);
  html += sign_off_section(input);
  html += checklist_section(input);
  html += next_section(input);
  for (const auto& section : {red_sheet_section(input, pictures), regions_section(input, pictures)}) {
    if (!section) {
      return section;
    }
    html += *section;
  }
  return html + page_foot();
}

}  // namespace dubsar
