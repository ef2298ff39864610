// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "archive/image.h"

namespace dubsar {

/// What stands in the place of a page whose verdict no longer is that of its session.
struct BehindPage {
  std::string title;   ///< as the page's own
  std::string kicker;  ///< "Checklist", "Scan report"
  std::string when;    ///< ISO 8601, UTC
  std::string what;    ///< "scan 4 was taken out"
  std::string mend;    ///< "run dubsar plan on the session"
};

/// One self-contained HTML page in the style of the report, that says so and nothing else: neither a verdict
/// nor a signature. Every outside text escaped. The same words give the same bytes.
[[nodiscard]] std::string behind_html(const BehindPage& page);

/// The same as a picture, in a few lines of ASCII.
[[nodiscard]] Image behind_picture(const BehindPage& page);

/// Whether it is such a page, by its first bytes (kBehindHeadBytes are enough).
[[nodiscard]] bool is_behind_page(std::string_view page);
inline constexpr std::size_t kBehindHeadBytes = 512;

}  // namespace dubsar
