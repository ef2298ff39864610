// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/report_sections.h"

namespace dubsar {

std::string checklist_html(const ReportInput& input, const ReportPictures& pictures) {
  std::string html = page_head(input, "checklist", "Checklist");
  html += verdict_section(input);
  html += sign_off_section(input);
  html += checklist_section(input);
  html += next_section(input);
  html += red_sheet_section(pictures);
  html += regions_section(input, pictures);
  return html + page_foot();
}

}  // namespace dubsar
