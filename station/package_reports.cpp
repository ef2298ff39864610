// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a package tells people.

#include <span>

#include "archive/page_pdf.h"
#include "archive/report_pictures.h"
#include "formats/atomic_file.h"
#include "station/package_content.h"
#include "station/picture_file.h"
#include "station/session_wedges.h"

namespace dubsar {

Status add_reports(PackageContent& content) {
  PageFacts facts = content.facts;
  facts.title = content.identifier;
  if (content.wedges) {
    facts.wedges =
        wedge_sentence({"wedges/wedges.json", content.wedges->wedges.size(), content.wedges->rejected.size()},
                       "wedges/wedges.json");
  }
  ReportInput input = report_input(content.planned.results, *content.planned.stage, facts);
  input.when = content.when;
  const Result<ReportPictures> pictures = draw_pictures(input, content.job);
  if (!pictures) {
    return std::unexpected(pictures.error());
  }
  const Result<std::string> report = report_html(input, *pictures);
  if (!report) {
    return std::unexpected(report.error());
  }
  if (const Status written = content.text("report/report.html", *report,
                                          "the report: verdict, what is excused and why, accuracy, pictures; "
                                          "one page that needs nothing else");
      !written) {
    return written;
  }
  const auto pdf = page_pdf(*report, {input.title + ": scan report", program_name(), content.when});
  if (!pdf) {
    return std::unexpected(pdf.error());
  }
  if (const Status written = write_file_atomically(content.root / "report" / "report.pdf",
                                                   std::as_bytes(std::span(pdf->data(), pdf->size())));
      !written) {
    return written;
  }
  content.list("report/report.pdf",
               "the same report for paper, A4; the six sides are life size where they fit");
  if (const Status written = content.text("report/checklist.html", checklist_html(input, *pictures),
                                          "the checklist with the sign-off, as it is filed");
      !written || pictures->empty) {
    return written;
  }
  if (const Status written = write_picture(content.root / "report" / "red_map.png", pictures->red_sheet,
                                           input.title + ", red map");
      !written) {
    return written;
  }
  content.list("report/red_map.png", "the six sides with what is red or excused");
  return {};
}

}  // namespace dubsar
