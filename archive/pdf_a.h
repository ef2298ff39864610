// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "archive/pdf_sheet.h"
#include "core/result.h"

namespace dubsar {

/// What cairo has written, in the form for archives, PDF/A-1b (ISO 19005-1): what its colours mean and what
/// is said of it stand in it in the ways asked for; nothing that is drawn changes. The same file gives the
/// same bytes. Errors: kInternal.
[[nodiscard]] Result<std::vector<std::uint8_t>> as_pdf_a(const std::vector<std::uint8_t>& pdf,
                                                         const PdfInfo& info);

}  // namespace dubsar
