// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/page_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "archive/base64.h"
#include "archive/page_pdf.h"
#include "archive/png.h"
#include "archive/render.h"
#include "build_paths.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using Kind = PageBlock::Kind;

std::string words(const RichText& text) {
  std::string all;
  for (const TextRun& run : text) {
    all += (run.breaks ? "|" : "") + run.text;
  }
  return all;
}

TEST(PageBlocks, KeepEveryWordInItsOrder) {
  const auto blocks = page_blocks(
      "<html><head><title>no</title><style>p { no: no }</style></head><body><h1>K. 1 &lt;a &amp; b&gt;</h1>\n"
      "<p>One\n  two <strong>three</strong>.</p><ol><li>first <span class=\"aside\">so</span></li><li>second"
      "</li></ol><dl><dt>Term</dt><dd>what it is</dd></dl><table><thead><tr><th>A</th><th>B</th></tr></thead>"
      "<tbody><tr><td>1<br>one</td><td></td></tr></tbody></table></body></html>");
  ASSERT_EQ(blocks.size(), 6U);
  EXPECT_EQ(blocks[0].kind, Kind::kHeading);
  EXPECT_EQ(blocks[0].level, 1);
  EXPECT_EQ(words(blocks[0].text), "K. 1 <a & b>");
  EXPECT_EQ(words(blocks[1].text), "One two three.");
  EXPECT_TRUE(blocks[1].text[1].bold);
  EXPECT_EQ(blocks[2].mark, "1.");
  EXPECT_TRUE(blocks[2].text[1].soft);
  EXPECT_EQ(blocks[3].mark, "2.");
  EXPECT_EQ(blocks[4].kind, Kind::kDefinition);
  EXPECT_EQ(blocks[4].mark, "Term");
  EXPECT_EQ(words(blocks[4].text), "what it is");
  ASSERT_EQ(blocks[5].rows.size(), 2U);
  EXPECT_EQ(words(blocks[5].rows[0][1]), "B");
  EXPECT_EQ(words(blocks[5].rows[1][0]), "1|one");
  EXPECT_EQ(words(blocks[5].rows[1][1]), "");
}

/// On paper there is no red: that a signature is void must not be paler than the rest.
TEST(PageBlocks, WhatIsVoidIsBoldAndWhatIsAsideIsSoft) {
  const auto blocks = page_blocks(
      "<p class=\"void\">It is void.</p><p>Plain.</p><p class=\"aside\">By the way.</p><footer>End</footer>");
  ASSERT_EQ(blocks.size(), 4U);
  EXPECT_TRUE(blocks[0].text[0].bold);
  EXPECT_FALSE(blocks[0].text[0].soft);
  EXPECT_FALSE(blocks[1].text[0].bold || blocks[1].text[0].soft);
  EXPECT_TRUE(blocks[2].text[0].soft && blocks[3].text[0].soft);
  EXPECT_FALSE(blocks[2].text[0].bold);
}

TEST(PageBlocks, TakePicturesOutOfThePage) {
  const std::string bytes = "not a picture, but bytes";
  const std::string uri =
      "data:image/png;base64," + base64({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  const auto blocks = page_blocks(
      "<div class=\"cross\"><figure><img width=\"30\" height=\"20\" style=\"--mm: "
      "12.50mm\" src=\"" +
      uri + "\"><figcaption>top</figcaption></figure></div><p>after</p>");
  ASSERT_EQ(blocks.size(), 2U);
  EXPECT_EQ(blocks[0].kind, Kind::kCross);
  ASSERT_EQ(blocks[0].figures.size(), 1U);
  const PageFigure& figure = blocks[0].figures[0];
  EXPECT_EQ(figure.png, bytes);
  EXPECT_EQ(figure.width_px, 30);
  EXPECT_EQ(figure.height_px, 20);
  EXPECT_DOUBLE_EQ(figure.width_mm, 12.5);
  EXPECT_EQ(words(figure.caption), "top");
}

TEST(PageBlocks, TakeTheLengthOfTheBarFromThePage) {
  const auto blocks = page_blocks(
      "<div class=\"cross\"><figure><img><figcaption>back</figcaption></figure><div class=\"bar\" "
      "style=\"--share: 60%\">5 mm</div></div><p>after</p><div class=\"bar\">7 mm</div>");
  ASSERT_EQ(blocks.size(), 2U);
  EXPECT_EQ(words(blocks[0].text), "5 mm");
  EXPECT_EQ(words(blocks[1].text), "after");
}

TEST(PageBlocks, TakeAnythingForAPage) {
  for (const char* broken : {"", "<", "<p", "<td>x", "<tr><td>", "<div class=\"bar\">5 mm",
                             "<img src=\"data:image/png;base64,?\">", "<figcaption>x", "</dt>", "<dd>x</dd>",
                             "<h9>", "<style>", "<p>&amp"}) {
    EXPECT_LE(page_blocks(broken).size(), 1U) << broken;
  }
}

/// Under the address sanitizer this was a write to what had been freed.
TEST(PageBlocks, FollowNoCaptionThatHasMoved) {
  std::string open = "<div class=\"cross\">";
  for (int i = 0; i < 20; ++i) {
    open += "<figure><figcaption>open <figure>lost ";
  }
  const auto blocks = page_blocks(open);
  ASSERT_EQ(blocks.size(), 1U);
  ASSERT_EQ(blocks[0].figures.size(), 40U);
  EXPECT_EQ(words(blocks[0].figures[0].caption), "open ");
  EXPECT_EQ(words(blocks[0].figures[1].caption), "");
}

TEST(PageBlocks, TakeNoSizeThatIsNone) {
  for (const char* size : {"-3", "nan", "inf", "x"}) {
    const auto blocks = page_blocks("<figure><img width=\"" + std::string(size) + "\" style=\"--mm: " + size +
                                    "mm\"></figure>");
    ASSERT_EQ(blocks.size(), 1U);
    EXPECT_EQ(blocks[0].figures.at(0).width_px, 0) << size;
    EXPECT_EQ(blocks[0].figures.at(0).width_mm, 0) << size;
  }
}

TEST(PagePdf, IsTheSameForTheSamePage) {
  std::string html = "<h1>Tablet</h1>";
  for (int i = 0; i < 200; ++i) {
    html += "<p>Line " + std::to_string(i) + " with ḫ and ŠÀ.</p>";
  }
  const PdfInfo info{"Tablet", "Dubsar", "2026-01-02T03:04:05Z"};
  const auto pdf = page_pdf(html, info);
  ASSERT_TRUE(pdf) << pdf.error().line();
  EXPECT_EQ(std::string(pdf->begin(), pdf->begin() + 5), "%PDF-");
  EXPECT_EQ(page_pdf(html, info).value(), *pdf);
}

void write(const std::filesystem::path& file, const std::vector<std::uint8_t>& pdf) {
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(pdf.data()), static_cast<std::streamsize>(pdf.size()));
}

void expect_for_archives(const std::vector<std::uint8_t>& pdf) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "page.pdf";
  write(file, pdf);
  const std::string check =
      "sh '" DUBSAR_SOURCE_DIR "/tests/support/check_pdf_a.sh' '" + file.string() + "' >&2";
  EXPECT_EQ(std::system(check.c_str()), 0)
      << "PDF/A-1b; to be held against it needs Java and PDFBox's Preflight (packages.txt)";
}

/// A page that is packed long after it was made has one time, not two.
TEST(PagePdf, AtTheFootIsTheTimeThatThePageSays) {
  const auto pdf = page_pdf("<h1>Tablet</h1><dl>\n<dt>Made</dt><dd>2025-12-31T23:59:59Z</dd>\n</dl>",
                            {"Tablet", "Dubsar", "2026-01-02T03:04:05Z"});
  ASSERT_TRUE(pdf) << pdf.error().line();
  const test::TemporaryFolder folder;
  write(folder.path() / "page.pdf", *pdf);
  const auto says = [&](const std::string& words) {
    const std::string search =
        "pdftotext '" + (folder.path() / "page.pdf").string() + "' - | grep -q '" + words + "'";
    return std::system(search.c_str()) == 0;
  };
  EXPECT_TRUE(says("2025-12-31T23:59:59Z")) << "install poppler-utils (packages.txt)";
  EXPECT_FALSE(says("2026-01-02"));
}

TEST(PagePdf, IsForArchives) {
  Image seen_through = filled_image(40, 30, {200, 100, 50}, 4);
  for (std::size_t k = 3; k < seen_through.bytes.size(); k += 8) {
    seen_through.bytes[k] = 100;
  }
  const auto uri = png_data_uri(seen_through, "half there");
  ASSERT_TRUE(uri);
  const auto pdf =
      page_pdf("<h1>Tablet ḫ</h1><p>ŠÀ, <b>3 µm ≤ 5</b></p><figure><img width=\"40\" height=\"30\" src=\"" +
                   *uri + "\"><figcaption>half there</figcaption></figure>",
               {"Tablet <ḫ> & \"others\"", "Dubsar", "2026-01-02T03:04:05Z"});
  ASSERT_TRUE(pdf) << pdf.error().line();
  expect_for_archives(*pdf);
}

/// What a program prints that is given the file.
std::string read_by(const std::string& program, const std::vector<std::uint8_t>& pdf,
                    const std::string& more = "") {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "page.pdf";
  write(file, pdf);
  const std::string command = program + " '" + file.string() + "' " + more;
  std::FILE* from = ::popen(command.c_str(), "r");
  std::string text;
  for (int c = std::fgetc(from); c != EOF; c = std::fgetc(from)) {
    text.push_back(static_cast<char>(c));
  }
  EXPECT_EQ(::pclose(from), 0) << "install poppler-utils (packages.txt)";
  return text;
}

std::string read_page(const std::vector<std::uint8_t>& pdf, int page) {
  const std::string number = std::to_string(page);
  return read_by("pdftotext -f " + number + " -l " + number, pdf, "-");
}

TEST(PagePdf, HasTheSameTitleWhereverItSaysIt) {
  // Marks that turn the direction of writing, what is no character, a control character, a stray byte.
  const auto pdf = page_pdf("<h1>Tablet</h1>", {"\u202aIM 4711\u202c \u2066a\uFDD0\uFFFE\x01\xFF <ḫ> & \"b\"",
                                                "Dubsar", "2026-01-02T03:04:05Z"});
  ASSERT_TRUE(pdf) << pdf.error().line();
  expect_for_archives(*pdf);
  const std::string title = "\uFFFDIM 4711\uFFFD \uFFFDa\uFFFD\uFFFD\uFFFD\uFFFD <ḫ> & \"b\"";
  EXPECT_NE(read_by("pdfinfo -enc UTF-8", *pdf).find("Title:           " + title + "\n"), std::string::npos);
}

// A script without blanks, a number that somebody pasted: once a line of it took time with its third power.
TEST(PagePdf, OneLongWordIsBrokenBetweenCharacters) {
  const auto word_of = [](int characters) {
    std::string word;
    for (int i = 0; i < characters; ++i) {
      word += i % 7 == 0 ? "ḫ" : i % 5 == 0 ? "Š" : std::string(1, static_cast<char>('a' + i % 26));
    }
    return word;
  };
  const PdfInfo info{"Tablet", "Dubsar", "2026-01-02T03:04:05Z"};
  const std::string word = word_of(3000);
  const auto pdf = page_pdf("<p>" + word + "</p>", info);
  ASSERT_TRUE(pdf) << pdf.error().line();
  std::string read = read_page(*pdf, 1);
  EXPECT_LT(std::count(read.begin(), read.end(), '\n'), 40);  // lines of 75 characters and more
  std::erase(read, '\n');
  EXPECT_TRUE(read.starts_with(word)) << read;
  EXPECT_TRUE(page_pdf("<p>" + word_of(100000) + "</p>", info));
}

/// Without the marks that pdftotext puts round text of a direction.
std::string read_plain(const std::vector<std::uint8_t>& pdf) {
  std::string text = read_page(pdf, 1);
  for (const char* mark : {"\u202a", "\u202b", "\u202c"}) {
    for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at)) {
      text.erase(at, std::string(mark).size());
    }
  }
  return text;
}

TEST(PagePdf, ArabicAndHebrewAreReadAsTheyAreWritten) {
  const PdfInfo info{"المتحف العراقي ١٢٣٤٥", "Dubsar", "2026-01-02T03:04:05Z"};
  const std::string html =
      "<h1>المتحف العراقي ١٢٣٤٥</h1><dl><dt>Collection</dt><dd>متحف (IM 12)، بغداد</dd><dt>مكان</dt>"
      "<dd>שלוֹם כהן, ירושלים</dd></dl><p>Signed by <b>أحمد رحيم</b> in İstanbul.</p>";
  const auto pdf = page_pdf(html, info);
  ASSERT_TRUE(pdf) << pdf.error().line();
  expect_for_archives(*pdf);
  EXPECT_EQ(page_pdf(html, info).value(), *pdf);
  const std::string read = read_plain(*pdf);
  for (const char* piece : {"المتحف العراقي ١٢٣٤٥\n", "متحف", "IM 12", "بغداد", "مكان", "שלוֹם כהן", "ירושלים",
                            "Signed by", "أحمد رحيم", "in İstanbul"}) {
    EXPECT_NE(read.find(piece), std::string::npos) << piece << "\n" << read;
  }
}

/// Where a word stands on the pages, points from the left. Letters as they are seen from left to right.
double left_of(const std::vector<std::uint8_t>& pdf, const std::string& word) {
  const std::string boxes = read_by("pdftotext -bbox", pdf, "-");
  const std::size_t at = boxes.find(">" + word + "</word>");
  EXPECT_NE(at, std::string::npos) << word << "\n" << boxes;
  const std::string key = "xMin=\"";
  return at == std::string::npos ? 0 : std::stod(boxes.substr(boxes.rfind(key, at) + key.size()));
}

TEST(PagePdf, ALineIsSeenInTheOrderOfItsDirection) {
  const PdfInfo info{"IM 1", "Dubsar", "2026-01-02T03:04:05Z"};
  const auto pdf = page_pdf("<p>one كتب ولد two</p><p>متحف IM 55357 بغداد</p>", info);
  ASSERT_TRUE(pdf) << pdf.error().line();
  const auto seen = [](std::string word) {
    for (std::size_t at = 0; at < word.size(); at += 2) {  // letters of two bytes
      std::swap(word[at], word[at + 1]);
    }
    return std::string(word.rbegin(), word.rend());
  };
  EXPECT_LT(left_of(*pdf, "one"), left_of(*pdf, seen("ولد")));
  EXPECT_LT(left_of(*pdf, seen("ولد")), left_of(*pdf, seen("كتب")));
  EXPECT_LT(left_of(*pdf, seen("كتب")), left_of(*pdf, "two"));
  EXPECT_LT(left_of(*pdf, seen("بغداد")), left_of(*pdf, "IM")) << "what begins in Arabic goes to the left";
  EXPECT_LT(left_of(*pdf, "IM"), left_of(*pdf, "55357"));
  EXPECT_LT(left_of(*pdf, "55357"), left_of(*pdf, seen("متحف")));
}

TEST(PagePdf, ArabicLinesAreBrokenAsTheyAreRead) {
  std::string words;
  for (int i = 0; i < 60; ++i) {
    words += i == 0 ? "متحف " : i == 59 ? "بغداد" : "كتب ";
  }
  const auto pdf = page_pdf("<p>" + words + "</p>", {"IM 1", "Dubsar", "2026-01-02T03:04:05Z"});
  ASSERT_TRUE(pdf) << pdf.error().line();
  const std::string read = read_plain(*pdf);
  EXPECT_TRUE(read.starts_with("متحف كتب")) << read;
  EXPECT_NE(read.find("كتب بغداد\n"), std::string::npos) << read;
  const std::string lines = read.substr(0, read.find("\n\n"));
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 2) << read;
}

TEST(PagePdf, WhatTheFontLacksIsSpeltOut) {
  const PdfInfo info{"\xF0\x92\x80\x80 \xFF", "Dubsar", "2026-01-02T03:04:05Z"};
  const auto pdf =
      page_pdf("<h1>\xF0\x92\x80\xAD an</h1><p>\xE5\xBA\xAB, ḫ <b>š\xF0\x92\x88\xA8</b></p>", info);
  ASSERT_TRUE(pdf) << pdf.error().line();
  const std::string read = read_page(*pdf, 1);
  EXPECT_TRUE(read.find("[U+1202D] an") != std::string::npos) << read;
  EXPECT_TRUE(read.find("[U+5EAB], ḫ š[U+12228]") != std::string::npos) << read;
  EXPECT_TRUE(read.find("[U+12000] \xEF\xBF\xBD, 2026") != std::string::npos) << read << "at the foot";
}

TEST(PagePdf, PutsNoBlankWhereThePageHasNone) {
  const PdfInfo info{"Tablet", "Dubsar", "2026-01-02T03:04:05Z"};
  std::string html = "<p>void: <strong>the session has changed since</strong>. And <b>so</b> on.</p>";
  html += "<p>";
  for (int k = 0; k < 400; ++k) {  // some of them stand at the end of a line
    html.append(static_cast<std::size_t>(1 + k % 9), 'w').append(" <strong>e</strong>. ");
  }
  const auto pdf = page_pdf(html + "</p>", info);
  ASSERT_TRUE(pdf) << pdf.error().line();
  const std::string read = read_page(*pdf, 1);
  EXPECT_NE(read.find("changed since. And so on."), std::string::npos) << read;
  EXPECT_EQ(read.find(" ."), std::string::npos) << read;
  EXPECT_EQ(read.find("\n."), std::string::npos) << read << "nor is a line broken there";
}

TEST(PagePdf, HasTheBarOfThePage) {
  Image image = filled_image(40, 40, {200, 200, 200});
  image.mm_per_px = 0.5;
  const auto uri = png_data_uri(image, "side");
  ASSERT_TRUE(uri);
  std::string html = "<div class=\"cross\">";
  for (int side = 0; side < 6; ++side) {
    html += "<figure><img width=\"40\" height=\"40\" style=\"--mm: 20mm\" src=\"" + *uri +
            "\"><figcaption>side</figcaption></figure>";
  }
  const PdfInfo info{"Tablet", "Dubsar", "2026-01-02T03:04:05Z"};
  const auto with_bar = [&](const std::string& words) {
    const auto pdf = page_pdf(html + "<div class=\"bar\">" + words + "</div></div>", info);
    EXPECT_TRUE(pdf) << pdf.error().line();
    return pdf ? read_page(*pdf, 1) : std::string();
  };
  EXPECT_NE(with_bar("5 mm").find("5 mm"), std::string::npos);
  for (const char* none : {"", "mm", "-5 mm", "inf mm", "900 mm", "5 cm"}) {
    EXPECT_EQ(with_bar(none).find("m"), std::string::npos) << none;
  }
}

TEST(PagePdf, SaysHowLargeTheSixSidesAreOnItsOwnPaper) {
  const auto printed = [](int height_px) {
    Image image = filled_image(40, height_px, {200, 200, 200});
    image.mm_per_px = 0.5;
    const auto uri = png_data_uri(image, "side");
    EXPECT_TRUE(uri);
    std::string html = "<div class=\"cross\">";
    for (int side = 0; side < 6; ++side) {
      html += "<figure><img width=\"40\" height=\"" + std::to_string(height_px) +
              "\" style=\"--mm: 20mm\" src=\"" + uri.value_or("") +
              "\"><figcaption>side</figcaption></figure>";
    }
    const auto pdf = page_pdf(
        html + "</div><p class=\"aside\">To one scale. Printed at 100 % they are life size.</p><p>More.</p>",
        {"Tablet", "Dubsar", "2026-01-02T03:04:05Z"});
    EXPECT_TRUE(pdf) << pdf.error().line();
    return pdf ? read_by("pdftotext", *pdf, "-") : std::string();
  };
  EXPECT_NE(printed(40).find("To one scale. Printed at 100 % they are life size.\n"), std::string::npos);
  // Four of 80 mm above each other are 329 mm with the gaps, and there is room for 235.
  const std::string high = printed(160);
  EXPECT_NE(high.find("To one scale. Printed at 100 % they are 71 % of life size.\n"), std::string::npos)
      << high;
  EXPECT_NE(high.find("More."), std::string::npos) << high;
}

TEST(PagePdf, AHeadingStandsOnThePageOfItsPicture) {
  Image image = filled_image(600, 700, {200, 200, 200});
  image.mm_per_px = 0.1;
  const auto uri = png_data_uri(image, "sheet");
  ASSERT_TRUE(uri);
  std::string html = "<h1>Tablet</h1>";
  for (int i = 0; i < 30; ++i) {  // half a page
    html += "<p>Line.</p>";
  }
  html += "<h2>Red map</h2><figure class=\"sheet\"><img width=\"600\" height=\"700\" src=\"" + *uri +
          "\"><figcaption>what it shows</figcaption></figure>";
  const auto pdf = page_pdf(html, {"Tablet", "Dubsar", "2026-01-02T03:04:05Z"});
  ASSERT_TRUE(pdf) << pdf.error().line();
  EXPECT_EQ(read_page(*pdf, 1).find("Red map"), std::string::npos);
  const std::string second = read_page(*pdf, 2);
  EXPECT_NE(second.find("Red map"), std::string::npos);
  EXPECT_NE(second.find("what it shows"), std::string::npos);
}

}  // namespace
}  // namespace dubsar
