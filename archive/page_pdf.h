// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "archive/pdf_sheet.h"
#include "core/result.h"

namespace dubsar {

/// A page of archive/report.h, which is HTML, as a PDF/A-1b on A4: the same words, tables and pictures in the
/// same order, at the foot of each sheet its number, the title and when the page was made. The six views are
/// life size where they fit on one sheet, and what the page says of their size is said of that sheet. The
/// same page gives the same bytes. Errors: kUsage where the fonts are not installed, kInternal.
[[nodiscard]] Result<std::vector<std::uint8_t>> page_pdf(std::string_view html, const PdfInfo& info);

}  // namespace dubsar
