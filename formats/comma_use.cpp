// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/comma_use.h"

#include <algorithm>

#include "formats/text_scanner.h"

namespace dubsar {

namespace {

constexpr std::size_t kCoordinates = 3;
constexpr const char* kUsePoints = "export the points with decimal points";

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool ends_word(char c) {
  return c == ' ' || c == ';' || (c >= '\t' && c <= '\r');
}

struct Word {
  std::size_t commas = 0;
  bool within = true;  ///< every comma stands between digits
  bool point = false;
  bool number = true;  ///< or numbers, with commas between
};

Word look_at(std::string_view text) {
  Word word;
  word.commas = static_cast<std::size_t>(std::ranges::count(text, ','));
  if (word.commas == 0) {
    double ignored = 0;
    word.number = parse_number(text, ignored);
    return word;
  }
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    word.point = word.point || c == '.';
    word.number = word.number && (is_digit(c) || std::string_view("+-.,eE").contains(c));
    if (c == ',') {
      word.within =
          word.within && i > 0 && i + 1 < text.size() && is_digit(text[i - 1]) && is_digit(text[i + 1]);
    }
  }
  return word;
}

/// 1,234 or 1,234.5: a comma may part thousands.
bool may_be_thousands(std::string_view word) {
  const std::size_t comma = word.find(',');
  const std::string_view behind = word.substr(comma + 1);
  return !word.substr(0, comma).contains('.') && behind.size() >= 3 &&
         std::ranges::all_of(behind.substr(0, 3), is_digit) && (behind.size() == 3 || behind[3] == '.');
}

}  // namespace

CommaUse comma_use(std::string_view line) {
  if (!line.contains(',')) {
    return CommaUse::kNone;
  }
  std::size_t words = 0;
  std::size_t commas = 0;
  bool between = false;  // for certain
  bool points = false;   // beside a comma
  bool any_point = false;
  bool thousands = true;       // all commas may be theirs
  bool in_coordinates = true;  // each of these has a comma
  for (auto at = line.begin();;) {
    at = std::find_if_not(at, line.end(), ends_word);
    const auto stop = std::find_if(at, line.end(), ends_word);
    const std::string_view text(at, stop);
    if (text.empty() || text.starts_with('#') || text.starts_with("//")) {
      break;
    }
    const Word word = look_at(text);
    if (!word.number) {
      return CommaUse::kNone;
    }
    between = between || word.commas > 1 || !word.within;
    points = points || (word.commas > 0 && word.point);
    any_point = any_point || text.contains('.');
    thousands = thousands && (word.commas == 0 || may_be_thousands(text));
    in_coordinates = in_coordinates && (words >= kCoordinates || word.commas == 1);
    commas += word.commas;
    ++words;
    at = stop;
  }
  if (commas == 0) {
    return CommaUse::kNone;
  }
  // Numbers with points have none that are commas.
  if (between || words < kCoordinates || (any_point && !thousands)) {
    return words + commas >= kCoordinates ? CommaUse::kSeparator : CommaUse::kNone;
  }
  return in_coordinates && !points ? CommaUse::kDecimal : CommaUse::kEither;
}

Result<bool> CommaReading::decimal(std::string_view line, std::string_view rest, std::size_t number,
                                   const std::string& name) {
  const CommaUse here = comma_use(line);
  if (here == CommaUse::kDecimal || here == CommaUse::kSeparator) {
    if (use_ != CommaUse::kNone && use_ != here) {
      return bad_input(name,
                       "line " + std::to_string(number) +
                           (here == CommaUse::kDecimal
                                ? ": its commas stand in numbers, those of other lines between them"
                                : ": its commas stand between numbers, those of other lines in them"),
                       kUsePoints);
    }
    use_ = here;
  }
  for (TextScanner text(rest);
       here == CommaUse::kEither && use_ == CommaUse::kNone && text.remaining() > 0;) {
    const CommaUse later = comma_use(text.line());
    use_ = later == CommaUse::kEither ? use_ : later;
  }
  if (here == CommaUse::kEither && use_ == CommaUse::kNone) {
    return bad_input(name,
                     "line " + std::to_string(number) +
                         ": nothing tells whether its commas stand in numbers or between them",
                     kUsePoints);
  }
  return use_ == CommaUse::kDecimal;
}

}  // namespace dubsar
