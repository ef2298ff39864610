// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/pdf_a.h"

#include <cairo.h>
#include <fmt/format.h>
#include <lcms2.h>

#include <memory>
#include <string>
#include <string_view>

#include "archive/html.h"
#include "archive/pdf_a_rewrite.h"
#include "archive/picture_words.h"

namespace dubsar {

namespace {

/// The sRGB profile, version 2, as PDF 1.4 takes it. Empty when it cannot be made.
std::string srgb_profile() {
  const std::unique_ptr<void, decltype(&cmsCloseProfile)> profile(cmsCreate_sRGBProfile(), &cmsCloseProfile);
  cmsSetProfileVersion(profile.get(), 2.1);
  cmsUInt32Number size = 0;
  if (!profile || !cmsSaveProfileToMem(profile.get(), nullptr, &size)) {
    return {};
  }
  std::string bytes(size, '\0');
  if (!cmsSaveProfileToMem(profile.get(), bytes.data(), &size)) {
    return {};
  }
  // When it was made, which would differ from run to run: 1 January 2000, six numbers of two bytes.
  constexpr std::size_t kDate = 24;
  constexpr std::string_view kMade("\x07\xD0\0\x01\0\x01\0\0\0\0\0\0", 12);
  bytes.replace(kDate, kMade.size(), kMade);
  return bytes;
}

/// 2026-01-02T03:04:05Z as D:20260102030405Z.
std::string pdf_date(std::string when) {
  std::erase_if(when, [](char c) { return c == '-' || c == ':' || c == 'T'; });
  return "D:" + when;
}

/// What the file says of itself, as XMP.
std::string xmp_of(const PdfInfo& info, const std::string& producer) {
  return fmt::format(
      R"(<?xpacket begin="{}" id="W5M0MpCehiHzreSzNTczkc9d"?>
<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">
<rdf:Description rdf:about="" xmlns:pdfaid="http://www.aiim.org/pdfa/ns/id/">
<pdfaid:part>1</pdfaid:part><pdfaid:conformance>B</pdfaid:conformance></rdf:Description>
<rdf:Description rdf:about="" xmlns:dc="http://purl.org/dc/elements/1.1/"><dc:format>application/pdf</dc:format>
{}</rdf:Description>
<rdf:Description rdf:about="" xmlns:xmp="http://ns.adobe.com/xap/1.0/"><xmp:CreatorTool>{}</xmp:CreatorTool>
<xmp:CreateDate>{}</xmp:CreateDate><xmp:ModifyDate>{}</xmp:ModifyDate></rdf:Description>
<rdf:Description rdf:about="" xmlns:pdf="http://ns.adobe.com/pdf/1.3/"><pdf:Producer>{}</pdf:Producer></rdf:Description>
</rdf:RDF></x:xmpmeta>
<?xpacket end="w"?>)",
      "\xEF\xBB\xBF",
      dublin_core({.title = info.title, .description = info.description, .copyright = info.rights}),
      html_escaped(info.program), info.when, info.when, html_escaped(producer));
}

}  // namespace

Result<std::vector<std::uint8_t>> as_pdf_a(const std::vector<std::uint8_t>& pdf, const PdfInfo& info) {
  PdfAWords words;
  words.title = cleaned(info.title);  // as it stands in the XMP: archives want the two the same
  words.program = info.program;
  words.producer = fmt::format("cairo {}", cairo_version_string());
  words.date = pdf_date(info.when);
  words.xmp = xmp_of(info, words.producer);
  words.profile = srgb_profile();
  std::string error = words.profile.empty() ? "the sRGB profile cannot be made" : "";
  if (error.empty()) {
    std::vector<std::uint8_t> out = rewrite_as_pdf_a(pdf, words, error);
    if (!out.empty()) {
      return out;
    }
  }
  return fail(ErrorKind::kInternal, error, "PDF");
}

}  // namespace dubsar
