// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/pdf_a_rewrite.h"

#define POINTERHOLDER_TRANSITION 4  // qpdf: std::shared_ptr and nothing older

#include <algorithm>
#include <exception>
#include <memory>
#include <qpdf/Buffer.hh>
#include <qpdf/QPDF.hh>
#include <qpdf/QPDFObjectHandle.hh>
#include <qpdf/QPDFWriter.hh>

namespace dubsar {

namespace {

/// What the file says of itself, in its own words and once more as XMP; the two must agree.
void describe(QPDF& pdf, const PdfAWords& words) {
  QPDFObjectHandle own = pdf.getTrailer().getKey("/Info");
  own.replaceKey("/Title", QPDFObjectHandle::newUnicodeString(words.title));
  own.replaceKey("/Creator", QPDFObjectHandle::newUnicodeString(words.program));
  own.replaceKey("/Producer", QPDFObjectHandle::newUnicodeString(words.producer));
  for (const char* date : {"/CreationDate", "/ModDate"}) {
    own.replaceKey(date, QPDFObjectHandle::newString(words.date));
  }
  QPDFObjectHandle metadata = QPDFObjectHandle::newStream(&pdf, words.xmp);
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
    dict.removeKey("/Group");  // that one could see through the page; pictures are put on white
    if (dict.getKey("/Subtype").isNameAndEquals("/CIDFontType2")) {
      name_letters(pdf, dict);
    }
  }
}

}  // namespace

std::vector<std::uint8_t> rewrite_as_pdf_a(const std::vector<std::uint8_t>& pdf, const PdfAWords& words,
                                           std::string& error) {
  // qpdf tells trouble by exceptions, which end here.
  try {
    QPDF document;
    document.setSuppressWarnings(true);
    document.processMemoryFile("PDF", reinterpret_cast<const char*>(pdf.data()), pdf.size());
    describe(document, words);
    say_colours(document, words.profile);
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
    error = e.what();
    return {};
  }
}

}  // namespace dubsar
