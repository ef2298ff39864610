// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/text_scanner.h"

#include <algorithm>
#include <array>
#include <clocale>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

namespace dubsar {

namespace {

constexpr std::size_t kMaxWordShown = 24;
/// No number that anyone writes is longer.
constexpr std::size_t kMaxNumberChars = 512;

bool is_blank(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

/// strtod in the C locale: a host may have set one with decimal commas.
double strtod_with_point(const char* text) {
  static const locale_t kWithPoint = newlocale(LC_ALL_MASK, "C", nullptr);
  return strtod_l(text, nullptr, kWithPoint);
}

/// What Microsoft's printf long wrote for what is no number: 1.#QNAN, -1.#IND, 1.#INF, filled up with zeros.
/// `stop` is at the #; null where none of these stands.
const char* end_of_no_number(const char* at, const char* stop, const char* end, double& value) {
  const std::string_view rest(stop, static_cast<std::size_t>(end - stop));
  for (const std::string_view name : {"#INF", "#IND", "#QNAN", "#SNAN"}) {
    if (stop[-1] == '.' && rest.starts_with(name)) {
      value = name != "#INF" ? std::numeric_limits<double>::quiet_NaN()
                             : std::copysign(std::numeric_limits<double>::infinity(), *at == '-' ? -1 : 1);
      return std::find_if_not(stop + name.size(), end, [](char c) { return c >= '0' && c <= '9'; });
    }
  }
  return nullptr;
}

/// from_chars, and zero or infinity where that gives up on the magnitude. Null when there is no number.
const char* number_at(const char* at, const char* end, double& value) {
  if (at != end && *at == '+' && at + 1 != end && at[1] != '-') {
    ++at;
  }
  const auto [stop, error] = std::from_chars(at, end, value);
  if (error == std::errc::result_out_of_range) {
    const std::string copy(at, std::min<std::size_t>(static_cast<std::size_t>(stop - at), kMaxNumberChars));
    value = strtod_with_point(copy.c_str());
    return stop;
  }
  if (error != std::errc{}) {
    return nullptr;
  }
  return stop != end && *stop == '#' ? end_of_no_number(at, stop, end, value) : stop;
}

}  // namespace

bool TextScanner::number(double& value) {
  skip_blanks();
  const char* stop = number_at(at_, end_, value);
  if (stop == nullptr || !ends_word(stop)) {
    return false;
  }
  at_ = stop;
  return true;
}

bool TextScanner::integer(std::int64_t& value) {
  skip_blanks();
  const char* from = at_ != end_ && *at_ == '+' ? at_ + 1 : at_;
  const auto [stop, error] = std::from_chars(from, end_, value);
  if (error == std::errc{} && ends_word(stop)) {
    at_ = stop;
    return true;
  }
  // Some exporters print whole numbers as 1.0 or 1e3.
  double real = 0;
  const char* keep = at_;
  if (number(real) && real >= -9.0e15 && real <= 9.0e15 &&
      real == static_cast<double>(static_cast<std::int64_t>(real))) {
    value = static_cast<std::int64_t>(real);
    return true;
  }
  at_ = keep;
  return false;
}

std::string_view TextScanner::line(char end) {
  const char* from = at_;
  const void* found = at_ == end_ ? nullptr : std::memchr(at_, end, remaining());
  at_ = found == nullptr ? end_ : static_cast<const char*>(found);
  std::string_view text(from, static_cast<std::size_t>(at_ - from));
  if (at_ != end_) {
    ++at_;
  }
  if (!text.empty() && text.back() == '\r') {
    text.remove_suffix(1);
  }
  return text;
}

std::string TextScanner::word_here() {
  skip_blanks();
  const char* stop = at_;
  while (!ends_word(stop) && static_cast<std::size_t>(stop - at_) < kMaxWordShown) {
    ++stop;
  }
  return {at_, stop};
}

std::size_t TextScanner::line_number() const {
  return 1 + static_cast<std::size_t>(std::count(begin_, at_, '\n'));
}

std::string with_line_feeds(std::string_view text) {
  std::string out(text);
  std::ranges::replace(out, '\r', '\n');
  return out;
}

std::string in_quotes(std::string_view word) {
  std::string text(1, '\'');
  text.append(word.substr(0, kMaxWordShown));
  text.append(1, '\'');
  return text;
}

std::string_view take_word(std::string_view& line) {
  const auto first = std::find_if_not(line.begin(), line.end(), is_blank);
  const auto stop = std::find_if(first, line.end(), is_blank);
  const std::string_view word(first, stop);
  line = std::string_view(stop, line.end());
  return word;
}

bool parse_number(std::string_view word, double& value) {
  return !word.empty() &&
         number_at(word.data(), word.data() + word.size(), value) == word.data() + word.size();
}

bool parse_number_or_comma(std::string_view word, double& value) {
  if (!word.contains(',') || word.contains('.') || word.size() > kMaxNumberChars) {
    return parse_number(word, value);
  }
  std::array<char, kMaxNumberChars> with_point{};
  std::replace_copy(word.begin(), word.end(), with_point.begin(), ',', '.');
  return parse_number({with_point.data(), word.size()}, value);
}

bool parse_integer(std::string_view word, std::int64_t& value) {
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return !word.empty() && error == std::errc{} && stop == word.data() + word.size();
}

}  // namespace dubsar
