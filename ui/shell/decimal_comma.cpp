// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/decimal_comma.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>
#include <vector>

namespace dubsar::ui {

namespace {

/// Where one holds another it stands first.
constexpr std::string_view kUnits[] = {
    "mm²", "mm2",  "mm", "µm",  "px", "°",  "%", "Grad", "deg", "GiB",   "MiB",
    "KiB", "Tage", "dB", "kHz", "Hz", "ms", "s", "d",    "h",   "Pixel", "Bilder in der Sekunde"};

class Comma : public std::numpunct<char> {
  [[nodiscard]] char do_decimal_point() const override { return ','; }
};

/// A number with a decimal point: from its sign on, and past its last digit.
struct Number {
  std::size_t first = 0;
  std::size_t past = 0;
};

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

/// A letter of any alphabet, a digit, or what joins them to a name.
bool is_of_a_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80 ||
         c == '_';
}

/// What the point at `at` stands in, if it is a number and no part of a word, a version or a path.
std::optional<Number> number_around(std::string_view text, std::size_t at) {
  Number out{at, at + 1};
  while (out.first > 0 && is_digit(text[out.first - 1])) {
    --out.first;
  }
  while (out.past < text.size() && is_digit(text[out.past])) {
    ++out.past;
  }
  if (out.first == at || out.past == at + 1) {
    return std::nullopt;
  }
  if (out.first > 0 && (text[out.first - 1] == '-' || text[out.first - 1] == '+')) {
    --out.first;
  }
  const bool begins = out.first == 0 || text[out.first - 1] == ' ' || text[out.first - 1] == '(';
  return begins ? std::optional(out) : std::nullopt;
}

bool has_unit(std::string_view text, std::size_t past) {
  if (past < text.size() && text[past] == ' ') {
    ++past;
  }
  const std::string_view rest = text.substr(past);
  const auto* unit =
      std::ranges::find_if(kUnits, [&](std::string_view one) { return rest.starts_with(one); });
  if (unit == std::end(kUnits)) {
    return false;
  }
  std::string_view after = rest.substr(unit->size());
  if (after.starts_with("/s")) {
    after.remove_prefix(2);
  }
  // "0.5 mm.ply", "0.5 mm/scan" and "0.5 mmx" are names.
  const bool joined = after.size() > 1 && (after[0] == '.' || after[0] == '-') && is_of_a_word(after[1]);
  return !joined && (after.empty() || (after[0] != '/' && !is_of_a_word(after[0])));
}

/// Something that a person gave a name stands there: a path, a file in brackets, or words in quotes.
bool is_in_a_name(std::string_view text, std::size_t at) {
  const std::string_view before = text.substr(0, at);
  if (std::ranges::count(before, '"') % 2 != 0 || std::ranges::count(before, '`') % 2 != 0) {
    return true;
  }
  std::size_t begin = 0;
  for (const std::string_view end_of_part : {": ", "; "}) {
    const std::size_t found = before.rfind(end_of_part);
    begin = found == std::string_view::npos ? begin : std::max(begin, found + end_of_part.size());
  }
  for (std::size_t slash = before.find('/', begin); slash != std::string_view::npos;
       slash = before.find('/', slash + 1)) {
    const std::string_view after = text.substr(slash + 1);
    const bool per_second = after.starts_with('s') && (after.size() == 1 || !is_of_a_word(after[1]));
    if (!per_second) {
      return true;
    }
  }
  // "scan 3 (tablet 0.5 mm fine.ply)"
  const std::size_t open = before.rfind('(');
  const std::size_t close = text.find(')', at);
  if (open == std::string_view::npos || close == std::string_view::npos ||
      before.find(')', open) != std::string_view::npos) {
    return false;
  }
  const std::string_view inside = text.substr(open + 1, close - open - 1);
  const std::size_t dot = inside.rfind('.');
  return dot != std::string_view::npos && dot + 1 < inside.size() &&
         std::isalpha(static_cast<unsigned char>(inside[dot + 1])) != 0;
}

}  // namespace

const std::locale& with_comma() {
  static const std::locale kComma(std::locale::classic(), new Comma);  // which owns it
  return kComma;
}

std::string decimal(std::string number, Language language) {
  if (language == Language::kGerman) {
    std::ranges::replace(number, '.', ',');
  }
  return number;
}

std::string decimal(double value, int decimals, Language language) {
  return decimal(fmt::format("{:.{}f}", value, decimals), language);
}

std::string with_decimal_commas(const std::string& sentence) {
  std::vector<Number> numbers;
  for (std::size_t at = sentence.find('.'); at != std::string::npos; at = sentence.find('.', at + 1)) {
    const std::optional<Number> number = number_around(sentence, at);
    if (number && !is_in_a_name(sentence, number->first)) {
      numbers.push_back(*number);
    }
  }
  std::string out = sentence;
  const auto put_comma = [&](const Number& number) { out[sentence.find('.', number.first)] = ','; };
  for (std::size_t k = 0; k < numbers.size();) {
    std::size_t last = k;  // of a place: "1.5, -2.25, 0.1"
    while (last + 1 < numbers.size() && numbers[last + 1].first == numbers[last].past + 2 &&
           sentence.compare(numbers[last].past, 2, ", ") == 0) {
      ++last;
    }
    const bool is_place = last > k;
    for (; k <= last; ++k) {
      if (is_place || has_unit(sentence, numbers[k].past)) {
        put_comma(numbers[k]);
      }
      if (is_place && k < last) {
        out[numbers[k].past] = ';';
      }
    }
  }
  return out;
}

}  // namespace dubsar::ui
