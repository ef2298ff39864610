// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/shaper.h"

#include <hb-ot.h>
#include <hb.h>

#include <algorithm>
#include <array>
#include <ranges>
#include <span>
#include <string>
#include <utility>

#include "core/utf8.h"

namespace dubsar {

namespace {

struct Destroy {
  void operator()(hb_blob_t* blob) const { hb_blob_destroy(blob); }
  void operator()(hb_face_t* face) const { hb_face_destroy(face); }
  void operator()(hb_font_t* font) const { hb_font_destroy(font); }
  void operator()(hb_buffer_t* buffer) const { hb_buffer_destroy(buffer); }
};
template <class Object>
using Owned = std::unique_ptr<Object, Destroy>;

/// A stretch of a text that is of one script.
struct Stretch {
  std::size_t from = 0;
  std::size_t bytes = 0;
  hb_script_t script = HB_SCRIPT_COMMON;
};

/// Digits, signs and marks, which all scripts have, go with what is before them; at the beginning with what
/// comes.
std::vector<Stretch> stretches_of(std::string_view text) {
  std::vector<Stretch> all(1);
  for (std::size_t at = 0; at < text.size();) {
    const CodePoint c = first_code_point(text.substr(at));
    const std::size_t bytes = std::max<std::size_t>(c.bytes, 1);
    const hb_script_t script = hb_unicode_script(hb_unicode_funcs_get_default(), c.value);
    if (script != HB_SCRIPT_COMMON && script != HB_SCRIPT_INHERITED && script != all.back().script) {
      if (all.back().script != HB_SCRIPT_COMMON) {
        all.push_back({at, 0, script});
      }
      all.back().script = script;
    }
    all.back().bytes += bytes;
    at += bytes;
  }
  return all;
}

std::string utf8_of(std::uint32_t code_point) {
  std::string out;
  const auto put = [&](std::uint32_t bits, std::uint32_t lead) {
    out.push_back(static_cast<char>(lead | bits));
  };
  const std::uint32_t more = code_point >= 0x10000 ? 3 : code_point >= 0x800 ? 2 : code_point >= 0x80 ? 1 : 0;
  constexpr std::array<std::uint32_t, 4> kLead = {0, 0xC0, 0xE0, 0xF0};
  put(code_point >> (6 * more), kLead[more]);
  for (std::uint32_t k = more; k > 0; --k) {
    put((code_point >> (6 * (k - 1))) & 0x3FU, 0x80);
  }
  return out;
}

/// Of text to the left, a bracket is drawn as its counterpart, and is that to whoever reads the page back.
std::string as_seen(std::string_view text, bool leftwards) {
  const CodePoint c = first_code_point(text);
  const hb_codepoint_t mirrored = hb_unicode_mirroring(hb_unicode_funcs_get_default(), c.value);
  return leftwards && c.bytes == text.size() && mirrored != c.value ? utf8_of(mirrored) : std::string(text);
}

}  // namespace

struct Shaper::Impl {
  Owned<hb_font_t> font;
  Owned<hb_buffer_t> buffer;
  double units_per_em = 1;

  /// Gives each glyph of a cluster what it stands for.
  void share_out(std::string_view text, std::span<ShapedGlyph> glyphs) const;
  /// Puts the stretch to the right of what is there already.
  void append(std::string_view text, const Stretch& stretch, bool leftwards, ShapedText& out) const;
};

Shaper::Shaper(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Shaper::Shaper(Shaper&&) noexcept = default;
Shaper::~Shaper() = default;

std::optional<Shaper> Shaper::open(const char* file) {
  const Owned<hb_blob_t> blob(hb_blob_create_from_file_or_fail(file));
  if (!blob) {
    return std::nullopt;
  }
  const Owned<hb_face_t> face(hb_face_create(blob.get(), 0));
  if (hb_face_get_glyph_count(face.get()) == 0) {
    return std::nullopt;
  }
  auto impl = std::make_unique<Impl>();
  impl->font.reset(hb_font_create(face.get()));  // its scale is the font's own: units of an em
  impl->units_per_em = hb_face_get_upem(face.get());
  impl->buffer.reset(hb_buffer_create());
  return Shaper(std::move(impl));
}

bool Shaper::has(std::uint32_t code_point) const {
  hb_codepoint_t glyph = 0;
  return hb_font_get_nominal_glyph(impl_->font.get(), code_point, &glyph) != 0;
}

void Shaper::Impl::share_out(std::string_view text, std::span<ShapedGlyph> glyphs) const {
  std::string joined;
  while (!text.empty() && glyphs.size() > 1) {
    const CodePoint c = first_code_point(text);
    const std::size_t bytes = std::max<std::size_t>(c.bytes, 1);  // what is no UTF-8 goes byte by byte
    hb_codepoint_t own = 0;
    hb_font_get_nominal_glyph(font.get(), c.value, &own);
    const auto glyph =
        std::ranges::find_if(glyphs, [&](const ShapedGlyph& g) { return g.index == own && g.text.empty(); });
    (glyph == glyphs.end() ? joined : glyph->text) += text.substr(0, bytes);
    text.remove_prefix(bytes);
  }
  const auto first = std::ranges::find_if(glyphs, [](const ShapedGlyph& g) { return g.text.empty(); });
  (first == glyphs.end() ? glyphs.back() : *first).text += joined + std::string(text);
}

void Shaper::Impl::append(std::string_view text, const Stretch& stretch, bool leftwards,
                          ShapedText& out) const {
  hb_buffer_t* const run = buffer.get();
  hb_buffer_reset(run);
  // With the whole text, so that letters join across.
  hb_buffer_add_utf8(run, text.data(), static_cast<int>(text.size()), static_cast<unsigned>(stretch.from),
                     static_cast<int>(stretch.bytes));
  hb_buffer_set_direction(run, leftwards ? HB_DIRECTION_RTL : HB_DIRECTION_LTR);
  hb_buffer_set_script(run, stretch.script);
  hb_buffer_set_language(run, hb_language_from_string("en", -1));  // not that of whoever runs the program
  // A mark is found by itself where the text is copied, and so is a joiner, which is seen nowhere.
  hb_buffer_set_cluster_level(run, HB_BUFFER_CLUSTER_LEVEL_MONOTONE_CHARACTERS);
  hb_buffer_set_flags(run, HB_BUFFER_FLAG_PRESERVE_DEFAULT_IGNORABLES);
  // Letters that need not be joined, as in "ffi", are each found by itself; lam and alif are always joined.
  const hb_feature_t no_ornament{HB_TAG('l', 'i', 'g', 'a'), 0, HB_FEATURE_GLOBAL_START,
                                 HB_FEATURE_GLOBAL_END};
  hb_shape(font.get(), run, &no_ornament, stretch.script == HB_SCRIPT_LATIN ? 1 : 0);

  unsigned count = 0;
  const hb_glyph_info_t* const infos = hb_buffer_get_glyph_infos(run, &count);
  const hb_glyph_position_t* const positions = hb_buffer_get_glyph_positions(run, &count);
  for (unsigned k = 0; k < count; ++k) {
    out.glyphs.push_back({infos[k].codepoint,
                          out.width + positions[k].x_offset / units_per_em,
                          positions[k].y_offset / units_per_em,
                          {}});
    out.width += positions[k].x_advance / units_per_em;
  }
  const std::span<ShapedGlyph> added = std::span(out.glyphs).last(count);
  for (unsigned from = 0; from < count;) {
    unsigned to = from + 1;
    while (to < count && infos[to].cluster == infos[from].cluster) {
      ++to;
    }
    const unsigned beyond = leftwards ? from - 1 : to;  // the cluster that is written next
    const std::size_t end = beyond < count ? infos[beyond].cluster : stretch.from + stretch.bytes;
    share_out(as_seen(text.substr(infos[from].cluster, end - infos[from].cluster), leftwards),
              added.subspan(from, to - from));
    from = to;
  }
}

ShapedText Shaper::shape(std::string_view text, bool leftwards) const {
  ShapedText out;
  std::vector<Stretch> stretches = stretches_of(text);
  if (leftwards) {
    std::ranges::reverse(stretches);
  }
  for (const Stretch& stretch : stretches) {
    impl_->append(text, stretch, leftwards, out);
  }
  return out;
}

bool is_mark(std::uint32_t code_point) {
  switch (hb_unicode_general_category(hb_unicode_funcs_get_default(), code_point)) {
    case HB_UNICODE_GENERAL_CATEGORY_NON_SPACING_MARK:
    case HB_UNICODE_GENERAL_CATEGORY_SPACING_MARK:
    case HB_UNICODE_GENERAL_CATEGORY_ENCLOSING_MARK:
      return true;
    default:
      return false;
  }
}

}  // namespace dubsar
