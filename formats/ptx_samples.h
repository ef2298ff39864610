// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <string>

#include "core/job.h"
#include "core/result.h"
#include "formats/scan_samples.h"
#include "formats/text_scanner.h"

namespace dubsar {

inline constexpr const char* kNoPtxMend = "the file is cut short or not PTX: copy or export it again";

/// The error with the line of the text's position.
[[nodiscard]] std::unexpected<Error> ptx_error(const TextScanner& text, const std::string& name,
                                               const std::string& what);

/// The samples of one PTX scan, a line each, blank lines between passed over; `mm` is millimetres per unit. A
/// line of 0 0 0 or of what is not finite is no return and may be shorter than the others. Errors name the
/// line; kCancelled soon after the job, where there is one, was.
[[nodiscard]] Result<ScanSamples> read_ptx_samples(TextScanner& text, char line_end, std::size_t cells,
                                                   double mm, const std::string& name, const JobContext* job);

}  // namespace dubsar
