// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a package tells people.

#include <span>

#include "archive/page_pdf.h"
#include "archive/png.h"
#include "archive/png_text.h"
#include "archive/report_pictures.h"
#include "formats/atomic_file.h"
#include "station/package_content.h"
#include "station/session_wedges.h"

namespace dubsar {

namespace {

/// A page of the session with what it says of the tablet and of its own files put right for the package.
std::string moved(std::string page, const PackageContent& content) {
  page = page_renamed(std::move(page), content.identifier, content.facts.tablet);
  const std::string from = "analysis/wedges.json";
  const std::string to = "wedges/wedges.json";
  for (std::size_t at = page.find(from); at != std::string::npos; at = page.find(from, at + to.size())) {
    page.replace(at, from.size(), to);
  }
  return page;
}

struct Pages {
  std::string report;
  std::string checklist;
  std::string red_sheet;  ///< PNG; empty when there is no surface
};

Result<Pages> pages_of(const PackageContent& content) {
  const PictureWords words = picture_words(content.label, content.identifier + ", red map");
  PageFacts facts = content.facts;
  facts.title = content.identifier;
  if (content.wedges) {
    const SessionWedges wedges = counts_of(*content.wedges, "wedges/wedges.json");
    facts.wedges = wedge_sentence(wedges, wedges.json.string());
    facts.wedge_profiles = wedges.profiles;
  } else if (!content.has(PackagePart::kWedges) && !facts.wedges.empty()) {
    facts.wedges = "They are left out of this package.";
  }
  if (const auto& kept = content.source.pages()) {
    Result<std::string> sheet = png_with_words(kept->red_sheet, words);
    if (!sheet) {
      return std::unexpected(sheet.error());
    }
    // What a person has corrected since does not make the verdict another one.
    std::string report = moved(kept->report, content);
    if (content.wedges || !content.has(PackagePart::kWedges)) {
      report = page_with_wedges(std::move(report), facts.wedges, facts.wedge_profiles);
    }
    return Pages{std::move(report), moved(kept->checklist, content), std::move(*sheet)};
  }
  ReportInput input = content.source.input(facts);
  input.when = content.when;
  const Result<ReportPictures> pictures = draw_pictures(input, content.job);
  if (!pictures) {
    return std::unexpected(pictures.error());
  }
  Result<std::string> report = report_html(input, *pictures);
  if (!report) {
    return std::unexpected(report.error());
  }
  Pages pages{std::move(*report), checklist_html(input, *pictures), {}};
  if (!pictures->empty) {
    const auto png = encode_png(pictures->red_sheet, words);
    if (!png) {
      return std::unexpected(png.error());
    }
    pages.red_sheet.assign(png->begin(), png->end());
  }
  return pages;
}

}  // namespace

Status add_reports(PackageContent& content) {
  const Result<Pages> pages = pages_of(content);
  if (!pages) {
    return std::unexpected(pages.error());
  }
  const PictureWords words = picture_words(content.label, content.identifier + ": scan report");
  const auto pdf = page_pdf(pages->report, {.title = words.title,
                                            .program = program_name(),
                                            .when = content.when,
                                            .description = words.description,
                                            .rights = words.copyright});
  if (!pdf) {
    return std::unexpected(pdf.error());
  }
  for (const Status& written :
       {content.text("report/report.html", pages->report,
                     "the report: verdict, what is excused and why, accuracy, pictures; one page that needs "
                     "nothing else"),
        content.text("report/report.pdf",
                     std::string_view(reinterpret_cast<const char*>(pdf->data()), pdf->size()),
                     "the same report for paper, A4; the six sides are life size where they fit"),
        content.text("report/checklist.html", pages->checklist,
                     "the checklist with the sign-off, as it is filed")}) {
    if (!written) {
      return written;
    }
  }
  return pages->red_sheet.empty() ? Status{}
                                  : content.text("report/red_map.png", pages->red_sheet,
                                                 "the six sides with what is red or excused");
}

}  // namespace dubsar
