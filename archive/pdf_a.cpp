// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/pdf_a.h"

#define POINTERHOLDER_TRANSITION 4  // qpdf: std::shared_ptr and nothing older

#include <fmt/format.h>
#include <lcms2.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <qpdf/Buffer.hh>
#include <qpdf/QPDF.hh>
#include <qpdf/QPDFObjectHandle.hh>
#include <qpdf/QPDFWriter.hh>
#include <string>

#include "archive/html.h"

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

/// What the file says of itself, in its own words and once more as XMP; the two must agree.
void describe(QPDF& pdf, const PdfInfo& info) {
  QPDFObjectHandle own = pdf.getTrailer().getKey("/Info");
  const std::string producer = own.getKey("/Producer").getUTF8Value();
  own.replaceKey("/Title", QPDFObjectHandle::newUnicodeString(info.title));
  own.replaceKey("/Creator", QPDFObjectHandle::newUnicodeString(info.program));
  for (const char* date : {"/CreationDate", "/ModDate"}) {
    own.replaceKey(date, QPDFObjectHandle::newString(pdf_date(info.when)));
  }
  const std::string xmp = fmt::format(
      R"(<?xpacket begin="{}" id="W5M0MpCehiHzreSzNTczkc9d"?>
<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">
<rdf:Description rdf:about="" xmlns:pdfaid="http://www.aiim.org/pdfa/ns/id/">
<pdfaid:part>1</pdfaid:part><pdfaid:conformance>B</pdfaid:conformance></rdf:Description>
<rdf:Description rdf:about="" xmlns:dc="http://purl.org/dc/elements/1.1/"><dc:format>application/pdf</dc:format>
<dc:title><rdf:Alt><rdf:li xml:lang="x-default">{}</rdf:li></rdf:Alt></dc:title></rdf:Description>
<rdf:Description rdf:about="" xmlns:xmp="http://ns.adobe.com/xap/1.0/"><xmp:CreatorTool>{}</xmp:CreatorTool>
<xmp:CreateDate>{}</xmp:CreateDate><xmp:ModifyDate>{}</xmp:ModifyDate></rdf:Description>
<rdf:Description rdf:about="" xmlns:pdf="http://ns.adobe.com/pdf/1.3/"><pdf:Producer>{}</pdf:Producer></rdf:Description>
</rdf:RDF></x:xmpmeta>
<?xpacket end="w"?>)",
      "\xEF\xBB\xBF", html_escaped(info.title), html_escaped(info.program), info.when, info.when,
      html_escaped(producer));
  QPDFObjectHandle metadata = QPDFObjectHandle::newStream(&pdf, xmp);
  metadata.getDict().replaceKey("/Type", QPDFObjectHandle::newName("/Metadata"));
  metadata.getDict().replaceKey("/Subtype", QPDFObjectHandle::newName("/XML"));
  pdf.getRoot().replaceKey("/Metadata", metadata);
}

/// What the numbers of its colours mean.
void say_colours(QPDF& pdf, const std::string& profile) {
  QPDFObjectHandle colours = QPDFObjectHandle::newStream(&pdf, profile);
  colours.getDict().replaceKey("/N", QPDFObjectHandle::newInteger(3));
  QPDFObjectHandle intent = QPDFObjectHandle::parse(
      "<< /Type /OutputIntent /S /GTS_PDFA1 /OutputConditionIdentifier (sRGB) /Info (sRGB IEC61966-2.1) >>");
  intent.replaceKey("/DestOutputProfile", colours);
  pdf.getRoot().replaceKey("/OutputIntents", QPDFObjectHandle::newArray({intent}));
}

/// Which numbers of letters a subset has, a bit each; those of cairo count from 0.
void name_letters(QPDF& pdf, QPDFObjectHandle font) {
  QPDFObjectHandle descriptor = font.getKey("/FontDescriptor");
  int letters = 0;
  QPDFObjectHandle widths = font.getKey("/W");  // runs: the first number and an array of widths
  for (int k = 0; k + 1 < widths.getArrayNItems(); k += 2) {
    letters = std::max(
        letters, widths.getArrayItem(k).getIntValueAsInt() + widths.getArrayItem(k + 1).getArrayNItems());
  }
  std::string bits((static_cast<std::size_t>(letters) + 7) / 8, '\0');
  for (int k = 0; k < letters; ++k) {
    auto& byte = bits[static_cast<std::size_t>(k) / 8];
    byte = static_cast<char>(static_cast<unsigned char>(byte) | (0x80U >> (static_cast<unsigned>(k) % 8U)));
  }
  descriptor.replaceKey("/CIDSet", QPDFObjectHandle::newStream(&pdf, bits));
  font.replaceKey("/CIDToGIDMap", QPDFObjectHandle::newName("/Identity"));
}

/// What cairo writes otherwise than archives want it.
void mend(QPDF& pdf) {
  for (QPDFObjectHandle object : pdf.getAllObjects()) {
    QPDFObjectHandle dict = object.isStream() ? object.getDict() : object;
    if (!dict.isDictionary()) {
      continue;
    }
    dict.removeKey(
        "/Group");  // that one could see through the page, which one cannot: pictures are put on white
    if (dict.getKey("/Subtype").isNameAndEquals("/CIDFontType2")) {
      name_letters(pdf, dict);
    }
  }
}

}  // namespace

Result<std::vector<std::uint8_t>> as_pdf_a(const std::vector<std::uint8_t>& pdf, const PdfInfo& info) {
  const std::string profile = srgb_profile();
  if (profile.empty()) {
    return fail(ErrorKind::kInternal, "the sRGB profile cannot be made", "PDF");
  }
  // qpdf tells trouble by exceptions, which end here.
  try {
    QPDF document;
    document.setSuppressWarnings(true);
    document.processMemoryFile("PDF", reinterpret_cast<const char*>(pdf.data()), pdf.size());
    describe(document, info);
    say_colours(document, profile);
    mend(document);
    QPDFWriter writer(document);
    writer.setOutputMemory();
    writer.setObjectStreamMode(qpdf_o_disable);
    writer.forcePDFVersion("1.4");
    writer.setDeterministicID(true);
    writer.setNewlineBeforeEndstream(true);
    writer.write();
    const std::shared_ptr<Buffer> out = writer.getBufferSharedPointer();
    return std::vector<std::uint8_t>(out->getBuffer(), out->getBuffer() + out->getSize());
  } catch (const std::exception& e) {
    return fail(ErrorKind::kInternal, e.what(), "PDF");
  }
}

}  // namespace dubsar
