// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Rows of tables on paper that are higher than a page: a long reason, many remarks on one scan.
#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "archive/page_pdf.h"
#include "archive/pdf_lines.h"

namespace dubsar {
namespace {

/// Lines of one word each, numbered from `first`.
PdfLines lines_from(int first, int count) {
  PdfLines lines;
  for (int k = 0; k < count; ++k) {
    PdfWord word;
    word.text = std::to_string(first + k);
    lines.emplace_back().words.push_back(word);
  }
  return lines;
}

TEST(PageTable, ARowIsPartedSoThatEveryLineIsInOnePart) {
  const auto parts = in_parts({lines_from(0, 7), lines_from(100, 2), {}}, 3);
  ASSERT_EQ(parts.size(), 3U);
  int next = 0;
  for (const auto& part : parts) {
    ASSERT_EQ(part.size(), 3U);
    EXPECT_LE(part[0].size(), 3U);
    for (const PdfLine& line : part[0]) {
      EXPECT_EQ(line.words[0].text, std::to_string(next++));
    }
  }
  EXPECT_EQ(next, 7);
  EXPECT_EQ(parts[0][1].size(), 2U);
  EXPECT_TRUE(parts[1][1].empty());
  EXPECT_EQ(in_parts({PdfLines(), PdfLines()}, 3).size(), 1U) << "an empty row is one";
  EXPECT_EQ(in_parts({lines_from(0, 2)}, 0).size(), 2U);
}

std::size_t pages_of(const std::string& html) {
  const auto pdf = page_pdf(html, {"Tablet", "Dubsar", "2026-01-02T03:04:05Z"});
  EXPECT_TRUE(pdf) << pdf.error().line();
  const std::string text = pdf ? std::string(pdf->begin(), pdf->end()) : std::string();
  std::size_t pages = 0;
  constexpr std::string_view kPage = "/Type /Page";
  for (std::size_t at = text.find(kPage); at != std::string::npos; at = text.find(kPage, at + 1)) {
    pages += text[at + kPage.size()] != 's' ? 1 : 0;
  }
  return pages;
}

TEST(PageTable, ARowThatIsHigherThanAPageGoesOnOverIt) {
  const auto table = [](int words) {
    std::string cell;
    for (int k = 0; k < words; ++k) {
      cell += "remark ";
    }
    return "<table><tr><th>No</th><th>Remark</th></tr><tr><td>0</td><td>" + cell + "</td></tr></table>";
  };
  EXPECT_EQ(pages_of(table(20)), 1U);
  EXPECT_GE(pages_of(table(4000)), 3U) << "what does not fit is not set below the paper's edge";
}

}  // namespace
}  // namespace dubsar
