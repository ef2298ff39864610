// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace dubsar {

inline constexpr double kPointsPerMm = 72.0 / 25.4;

enum class PdfFont { kPlain, kBold };

struct PdfInfo {
  std::string title;
  std::string program;
  std::string when;  ///< ISO 8601, UTC: the document's date, so that the same input gives the same bytes
  std::string description{};  ///< lines parted by line feeds; empty: none
  std::string rights{};       ///< whose it is, and its licence; likewise
};

/// A PDF in the making, for archives (PDF/A-1b): A4 pages, points from the lower left corner, fonts embedded
/// as subsets. It begins with an empty page. After a failure everything is a no-op and bytes() tells it.
class PdfSheet {
 public:
  static constexpr double kWidth = 210 * kPointsPerMm;
  static constexpr double kHeight = 297 * kPointsPerMm;

  /// kUsage where the fonts are not installed.
  [[nodiscard]] static Result<PdfSheet> make(const PdfInfo& info);
  PdfSheet(PdfSheet&&) noexcept;
  PdfSheet& operator=(PdfSheet&&) = delete;
  ~PdfSheet();

  void new_page();
  [[nodiscard]] int pages() const;

  /// Of text of one direction (archive/bidi.h), letters joined.
  [[nodiscard]] double text_width(std::string_view text, bool leftwards, PdfFont font, double size) const;
  /// UTF-8, each character that the fonts lack spelt out as "[U+12000]": as boxes they would look all alike,
  /// and be lost where the text is copied.
  [[nodiscard]] std::string spelt(std::string_view text) const;
  /// Text of one direction, its left end at x, its baseline at y. UTF-8, spelt() where it comes from outside.
  /// grey: 0 black to 1 white.
  void text(std::string_view text, bool leftwards, double x, double y, PdfFont font, double size,
            double grey);
  void line(double x0, double y0, double x1, double y1, double width, double grey);
  /// An entry of the document's outline that leads to a height of this page. It belongs to the last entry of
  /// a smaller level before it; levels count from 1.
  void bookmark(std::string_view text, double y, int level);
  /// A PNG file's bytes, into the rectangle; what can be seen through it is white.
  void picture(const std::string& png, double x, double y, double width, double height);

  /// The finished file. Nothing may be added afterwards. Errors: kInternal.
  [[nodiscard]] Result<std::vector<std::uint8_t>> bytes();

 private:
  struct Impl;
  explicit PdfSheet(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace dubsar
