// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dubsar {

/// What stands in a PDF/A beside its pages.
struct PdfAWords {
  std::string title, program, producer;
  std::string date;     ///< as PDF writes it
  std::string xmp;      ///< the same once more, as XMP
  std::string profile;  ///< ICC, of its RGB colours
};

/// The file with these words and with what cairo writes otherwise than archives want it put right; empty, and
/// why in `error`, where qpdf refuses. By itself, and C++17, for Clang before 17 cannot compile qpdf's
/// headers as C++20.
[[nodiscard]] std::vector<std::uint8_t> rewrite_as_pdf_a(const std::vector<std::uint8_t>& pdf,
                                                         const PdfAWords& words, std::string& error);

}  // namespace dubsar
