// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/page_blocks.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "archive/base64.h"

namespace dubsar {

namespace {

std::string without_entities(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, char>, 5> kEntities = {
      {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&#39;", '\''}}};
  std::string out;
  while (!text.empty()) {
    bool found = false;
    for (const auto& [entity, character] : kEntities) {
      if (text.starts_with(entity)) {
        out.push_back(character);
        text.remove_prefix(entity.size());
        found = true;
        break;
      }
    }
    if (!found) {
      out.push_back(text.front());
      text.remove_prefix(1);
    }
  }
  return out;
}

struct Tag {
  std::string_view name;
  std::string_view whole;  ///< between the brackets
  bool closes = false;

  [[nodiscard]] std::string_view attribute(std::string_view key) const {
    const std::string begin = std::string(key) + "=\"";
    const std::size_t at = whole.find(begin);
    if (at == std::string_view::npos) {
      return {};
    }
    const std::size_t from = at + begin.size();
    return whole.substr(from, whole.find('"', from) - from);
  }
};

template <class Number>
Number number_of(std::string_view text) {
  Number value{};
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// Goes through the page once, keeping what it is in the middle of.
class Reader {
 public:
  std::vector<PageBlock> read(std::string_view html) {
    while (!html.empty()) {
      const std::size_t open = html.find('<');
      text(html.substr(0, open));
      if (open == std::string_view::npos) {
        break;
      }
      const std::size_t close = html.find('>', open);
      if (close == std::string_view::npos) {
        break;
      }
      Tag tag;
      tag.whole = html.substr(open + 1, close - open - 1);
      tag.closes = tag.whole.starts_with('/');
      const std::string_view named = tag.whole.substr(tag.closes ? 1 : 0);
      tag.name = named.substr(0, named.find_first_of(" \n\t"));
      html.remove_prefix(close + 1);
      if (tag.name == "style" || tag.name == "title") {  // nothing to be read
        const std::string end = "</" + std::string(tag.name) + ">";
        const std::size_t past = html.find(end);
        html.remove_prefix(past == std::string_view::npos ? html.size() : past + end.size());
        continue;
      }
      element(tag);
    }
    return std::move(blocks_);
  }

 private:
  void text(std::string_view raw) {
    if (into_ == nullptr) {
      return;
    }
    const std::string plain = without_entities(raw);
    for (const char c : plain) {
      const bool blank = c == ' ' || c == '\n' || c == '\t' || c == '\r';
      if (into_->empty() || into_->back().bold != bold_ || into_->back().soft != soft_ || breaks_) {
        if (blank && (into_->empty() || breaks_)) {
          continue;
        }
        into_->push_back({{}, bold_, soft_, breaks_});
        breaks_ = false;
      }
      std::string& so_far = into_->back().text;
      if (!blank) {
        so_far.push_back(c);
      } else if (so_far.empty() || so_far.back() != ' ') {
        so_far.push_back(' ');
      }
    }
  }

  PageBlock& begin(PageBlock::Kind kind) {
    PageBlock& block = blocks_.emplace_back();
    block.kind = kind;
    into_ = &block.text;
    bold_ = soft_ = breaks_ = false;
    return block;
  }

  void element(const Tag& tag) {
    const std::string_view name = tag.name;
    if (name == "b" || name == "strong") {
      bold_ = !tag.closes;
    } else if (name == "br") {
      breaks_ = true;
    } else if (name == "span" && tag.attribute("class") == "aside") {
      soft_ = !tag.closes;
    } else if (name == "span" && tag.closes) {
      soft_ = false;
    } else if (name == "span") {
      swatch(tag);
    } else if (name.size() == 2 && name[0] == 'h' && name[1] >= '1' && name[1] <= '3') {
      block(tag, PageBlock::Kind::kHeading);
      if (!tag.closes) {
        blocks_.back().level = name[1] - '0';
      }
    } else if (name == "p" || name == "footer") {
      block(tag, PageBlock::Kind::kParagraph);
      const std::string_view look = tag.attribute("class");
      bold_ = !tag.closes && look == "void";  // that a signature does not hold
      soft_ = !tag.closes && !bold_ && (name == "footer" || !look.empty());
      if (!tag.closes && look == "line") {
        blocks_.back().level = 1;
      }
    } else if (name == "ul" || name == "ol") {
      number_ = name == "ol" && !tag.closes ? 1 : 0;
    } else if (name == "li") {
      block(tag, PageBlock::Kind::kItem);
      if (!tag.closes) {
        blocks_.back().mark = number_ > 0 ? std::to_string(number_++) + "." : "\xe2\x80\xa2";
      }
    } else {
      composite(tag);
    }
  }

  /// The legend of a picture: what its colour was becomes a word.
  void swatch(const Tag& tag) {
    const std::string_view style = tag.attribute("style");
    constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kNames = {
        {{"#d61e26", "red"}, {"#e2a02a", "amber"}, {"#3a3638", "dark"}}};
    std::string_view colour = "ring";
    for (const auto& [value, word] : kNames) {
      if (style.find(value) != std::string_view::npos) {
        colour = word;
      }
    }
    if (into_ != nullptr) {
      const bool first = into_->empty();
      text((first ? "" : "; ") + std::string(colour) + ": ");
    }
  }

  void block(const Tag& tag, PageBlock::Kind kind) {
    if (tag.closes) {
      into_ = nullptr;
      return;
    }
    begin(kind);
  }

  void composite(const Tag& tag) {
    const std::string_view name = tag.name;
    if (name == "dt" && !tag.closes) {
      begin(PageBlock::Kind::kDefinition);
    } else if (name == "dt" && !blocks_.empty()) {
      std::string mark;
      for (const TextRun& run : blocks_.back().text) {
        mark += run.text;
      }
      blocks_.back().mark = std::move(mark);
      blocks_.back().text.clear();
      into_ = nullptr;
    } else if (name == "dd") {
      into_ = tag.closes || blocks_.empty() ? nullptr : &blocks_.back().text;
    } else if (name == "table" && !tag.closes) {
      begin(PageBlock::Kind::kTable);
      into_ = nullptr;
    } else if (name == "tr" && !tag.closes && in_table()) {
      blocks_.back().rows.emplace_back();
    } else if ((name == "td" || name == "th") && in_table() && !blocks_.back().rows.empty()) {
      into_ = tag.closes ? nullptr : &blocks_.back().rows.back().emplace_back();
      bold_ = soft_ = breaks_ = false;
    } else if (name == "div" && !tag.closes && tag.attribute("class") == "cross") {
      begin(PageBlock::Kind::kCross);
      into_ = nullptr;
    } else if (name == "div" && !tag.closes && tag.attribute("class") == "places") {
      begin(PageBlock::Kind::kFigures);
      into_ = nullptr;
    } else if (name == "div" && !tag.closes && tag.attribute("class") == "bar" && in_cross()) {
      into_ = &blocks_.back().text;
    } else if (name == "div") {
      into_ = nullptr;
    } else if (name == "figure" && !tag.closes) {
      const bool among =
          !blocks_.empty() && (in_cross() || (blocks_.back().kind == PageBlock::Kind::kFigures &&
                                              tag.attribute("class") != "sheet"));
      if (!among) {
        begin(PageBlock::Kind::kFigures);
      }
      blocks_.back().figures.emplace_back();
      into_ = nullptr;  // a caption that was never closed may have moved
    } else if (name == "img" && in_figure()) {
      image(tag, blocks_.back().figures.back());
    } else if (name == "figcaption") {
      into_ = tag.closes || !in_figure() ? nullptr : &blocks_.back().figures.back().caption;
      bold_ = soft_ = breaks_ = false;
    }
  }

  static void image(const Tag& tag, PageFigure& figure) {
    constexpr std::string_view kData = "data:image/png;base64,";
    const std::string_view source = tag.attribute("src");
    if (source.starts_with(kData)) {
      figure.png = from_base64(source.substr(kData.size())).value_or("");
    }
    figure.width_px = std::max(0, number_of<int>(tag.attribute("width")));
    figure.height_px = std::max(0, number_of<int>(tag.attribute("height")));
    const std::string_view style = tag.attribute("style");
    constexpr std::string_view kMm = "--mm: ";
    if (const std::size_t at = style.find(kMm); at != std::string_view::npos) {
      const double width_mm = number_of<double>(style.substr(at + kMm.size()));
      figure.width_mm = std::isfinite(width_mm) && width_mm > 0 ? width_mm : 0;
    }
  }

  [[nodiscard]] bool in_table() const {
    return !blocks_.empty() && blocks_.back().kind == PageBlock::Kind::kTable;
  }
  [[nodiscard]] bool in_cross() const {
    return !blocks_.empty() && blocks_.back().kind == PageBlock::Kind::kCross;
  }
  [[nodiscard]] bool in_figure() const { return !blocks_.empty() && !blocks_.back().figures.empty(); }

  std::vector<PageBlock> blocks_;
  RichText* into_ = nullptr;  ///< points into the last block
  bool bold_ = false;
  bool soft_ = false;
  bool breaks_ = false;
  int number_ = 0;  ///< of the next item of an ordered list; 0: not ordered
};

}  // namespace

std::vector<PageBlock> page_blocks(std::string_view html) {
  return Reader().read(html);
}

}  // namespace dubsar
