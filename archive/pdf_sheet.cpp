// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// cairo embeds the letters that are used, with the table that tells what they are, so that the text can be
// found and copied. (libharu, which is smaller, writes that table so that others cannot read it.) HarfBuzz
// says which forms of a font the letters of a text have; cairo's own text knows neither joined letters nor
// those that are written to the left.
#include "archive/pdf_sheet.h"

#include <cairo-ft.h>
#include <cairo-pdf.h>
#include <fmt/format.h>
#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "archive/pdf_a.h"
#include "archive/shaper.h"
#include "core/utf8.h"

namespace dubsar {

namespace {

constexpr std::array<const char*, 2> kFontFiles = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                                   "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf"};

/// One for the program: cairo may keep a font in its cache for longer than anybody here uses it.
struct FontLibrary {
  std::mutex mutex;  ///< FreeType opens and closes faces one at a time
  FT_Library library = nullptr;
  FontLibrary() { FT_Init_FreeType(&library); }
};
FontLibrary& fonts() {
  static auto* const kFonts = new FontLibrary;  // lives until the end, after cairo's own caches
  return *kFonts;
}

const cairo_user_data_key_t kFaceOfFont{};

/// Null when the file is no font.
cairo_font_face_t* open_font(const char* file) {
  FT_Face face = nullptr;
  {
    const std::scoped_lock lock(fonts().mutex);
    if (fonts().library == nullptr || FT_New_Face(fonts().library, file, 0, &face) != 0) {
      return nullptr;
    }
  }
  cairo_font_face_t* font = cairo_ft_font_face_create_for_ft_face(face, FT_LOAD_NO_HINTING);
  cairo_font_face_set_user_data(font, &kFaceOfFont, face, [](void* owned) {
    const std::scoped_lock lock(fonts().mutex);
    FT_Done_Face(static_cast<FT_Face>(owned));
  });
  return font;
}

cairo_status_t append(void* into, const unsigned char* bytes, unsigned int count) {
  auto* all = static_cast<std::vector<std::uint8_t>*>(into);
  all->insert(all->end(), bytes, bytes + count);
  return CAIRO_STATUS_SUCCESS;
}

/// What is left of a PNG that cairo reads.
struct Rest {
  const char* at;
  std::size_t count;
};
cairo_status_t take(void* from, unsigned char* into, unsigned int count) {
  auto* rest = static_cast<Rest*>(from);
  if (count > rest->count) {
    return CAIRO_STATUS_READ_ERROR;
  }
  std::memcpy(into, rest->at, count);
  rest->at += count;
  rest->count -= count;
  return CAIRO_STATUS_SUCCESS;
}

/// PDF/A-1 knows nothing that is seen through, and no viewer may make up pixels between those of a picture.
cairo_surface_t* on_white(cairo_surface_t* image, int columns, int rows) {
  cairo_surface_t* opaque = cairo_image_surface_create(CAIRO_FORMAT_RGB24, columns, rows);
  cairo_t* paint = cairo_create(opaque);
  cairo_set_source_rgb(paint, 1, 1, 1);
  cairo_paint(paint);
  cairo_set_source_surface(paint, image, 0, 0);
  cairo_paint(paint);
  cairo_destroy(paint);
  return opaque;
}

std::string terminated(std::string_view text) {
  return std::string(text.substr(0, text.find('\0')));
}

}  // namespace

/// Everything of C, taken down in the order that its owners ask for.
struct PdfSheet::Impl {
  PdfInfo info;
  std::vector<std::uint8_t> bytes;
  std::array<cairo_font_face_t*, 2> font{};
  std::vector<Shaper> shapers;  ///< likewise, one a font
  cairo_surface_t* surface = nullptr;
  cairo_t* page = nullptr;
  int pages = 1;
  std::vector<std::pair<int, int>>
      open_entries;  ///< level and cairo's number of those that others may belong to

  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    cairo_destroy(page);
    cairo_surface_destroy(surface);
    for (cairo_font_face_t* face : font) {
      cairo_font_face_destroy(face);
    }
  }

  /// False once anything has failed: cairo goes on, doing nothing.
  [[nodiscard]] bool good() const { return cairo_status(page) == CAIRO_STATUS_SUCCESS; }
  [[nodiscard]] bool has(std::uint32_t code_point) const {  ///< in both fonts
    return std::ranges::all_of(shapers, [&](const Shaper& shaper) { return shaper.has(code_point); });
  }
  [[nodiscard]] ShapedText shaped(std::string_view text, bool leftwards, PdfFont which) const {
    return shapers[static_cast<std::size_t>(which)].shape(text, leftwards);
  }
};

PdfSheet::PdfSheet(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PdfSheet::PdfSheet(PdfSheet&&) noexcept = default;
PdfSheet::~PdfSheet() = default;

Result<PdfSheet> PdfSheet::make(const PdfInfo& info) {
  auto impl = std::make_unique<Impl>();
  impl->info = info;
  for (std::size_t k = 0; k < kFontFiles.size(); ++k) {
    impl->font[k] = open_font(kFontFiles[k]);
    std::optional<Shaper> shaper = Shaper::open(kFontFiles[k]);
    if (impl->font[k] == nullptr || !shaper) {
      return fail(ErrorKind::kUsage, "the font for PDF files is missing", kFontFiles[k],
                  "install fonts-dejavu-core");
    }
    impl->shapers.push_back(std::move(*shaper));
  }
  impl->surface = cairo_pdf_surface_create_for_stream(append, &impl->bytes, kWidth, kHeight);
  cairo_pdf_surface_restrict_to_version(impl->surface, CAIRO_PDF_VERSION_1_4);
  impl->page = cairo_create(impl->surface);
  if (!impl->good()) {
    return fail(ErrorKind::kInternal, cairo_status_to_string(cairo_status(impl->page)), "PDF");
  }
  return PdfSheet(std::move(impl));
}

void PdfSheet::new_page() {
  cairo_show_page(impl_->page);
  ++impl_->pages;
}

int PdfSheet::pages() const {
  return impl_->pages;
}

std::string PdfSheet::spelt(std::string_view text) const {
  const std::string whole = as_utf8(text);
  std::string out;
  for (std::string_view rest = whole; !rest.empty();) {
    const CodePoint c = first_code_point(rest);
    const bool shown = is_control(c.value) || impl_->has(c.value);
    out += shown ? std::string(rest.substr(0, c.bytes)) : fmt::format("[U+{:04X}]", c.value);
    rest.remove_prefix(c.bytes);
  }
  return out;
}

double PdfSheet::text_width(std::string_view text, bool leftwards, PdfFont font, double size) const {
  return size * impl_->shaped(text, leftwards, font).width;
}

void PdfSheet::text(std::string_view text, bool leftwards, double x, double y, PdfFont font, double size,
                    double grey) {
  const ShapedText shaped = impl_->shaped(text, leftwards, font);
  std::string told;
  std::vector<cairo_glyph_t> glyphs;
  std::vector<cairo_text_cluster_t> clusters;
  for (const ShapedGlyph& glyph : shaped.glyphs) {
    glyphs.push_back({glyph.index, x + size * glyph.x, kHeight - y - size * glyph.y});
    clusters.push_back({static_cast<int>(glyph.text.size()), 1});
    told += glyph.text;
  }
  cairo_set_font_face(impl_->page, impl_->font[static_cast<std::size_t>(font)]);
  cairo_set_font_size(impl_->page, size);
  cairo_set_source_rgb(impl_->page, grey, grey, grey);
  cairo_show_text_glyphs(impl_->page, told.data(), static_cast<int>(told.size()), glyphs.data(),
                         static_cast<int>(glyphs.size()), clusters.data(), static_cast<int>(clusters.size()),
                         cairo_text_cluster_flags_t{});
}

void PdfSheet::line(double x0, double y0, double x1, double y1, double width, double grey) {
  cairo_set_source_rgb(impl_->page, grey, grey, grey);
  cairo_set_line_width(impl_->page, width);
  cairo_move_to(impl_->page, x0, kHeight - y0);
  cairo_line_to(impl_->page, x1, kHeight - y1);
  cairo_stroke(impl_->page);
}

void PdfSheet::bookmark(std::string_view text, double y, int level) {
  auto& open = impl_->open_entries;
  while (!open.empty() && open.back().first >= level) {
    open.pop_back();
  }
  // Of the entry's place cairo wants a point from the upper left corner.
  const std::string place = "page=" + std::to_string(impl_->pages) + " pos=[0 " +
                            std::to_string(std::lround(std::max(0.0, kHeight - y))) + "]";
  const int entry = cairo_pdf_surface_add_outline(
      impl_->surface, open.empty() ? CAIRO_PDF_OUTLINE_ROOT : open.back().second, terminated(text).c_str(),
      place.c_str(), CAIRO_PDF_OUTLINE_FLAG_OPEN);
  open.emplace_back(level, entry);
}

void PdfSheet::picture(const std::string& png, double x, double y, double width, double height) {
  Rest rest{png.data(), png.size()};
  cairo_surface_t* image = cairo_image_surface_create_from_png_stream(take, &rest);
  if (cairo_surface_status(image) == CAIRO_STATUS_SUCCESS) {
    const int columns = cairo_image_surface_get_width(image);
    const int rows = cairo_image_surface_get_height(image);
    cairo_surface_t* opaque = on_white(image, columns, rows);
    cairo_save(impl_->page);
    cairo_translate(impl_->page, x, kHeight - y - height);
    cairo_scale(impl_->page, width / columns, height / rows);
    cairo_set_source_surface(impl_->page, opaque, 0, 0);
    cairo_pattern_set_filter(cairo_get_source(impl_->page), CAIRO_FILTER_FAST);
    cairo_paint(impl_->page);
    cairo_restore(impl_->page);
    cairo_surface_destroy(opaque);
  }
  cairo_surface_destroy(image);
}

Result<std::vector<std::uint8_t>> PdfSheet::bytes() {
  if (impl_->good()) {
    cairo_show_page(impl_->page);
  }
  const cairo_status_t drawn = cairo_status(impl_->page);
  cairo_surface_finish(impl_->surface);
  const cairo_status_t finished = cairo_surface_status(impl_->surface);
  if (drawn != CAIRO_STATUS_SUCCESS || finished != CAIRO_STATUS_SUCCESS) {
    return fail(ErrorKind::kInternal,
                cairo_status_to_string(drawn != CAIRO_STATUS_SUCCESS ? drawn : finished), "PDF");
  }
  return as_pdf_a(impl_->bytes, impl_->info);
}

}  // namespace dubsar
