// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace dubsar {

/// Walks over text number by number; line ends count as blanks. Never reads past the end, never allocates.
/// The line number is counted only when an error asks for it.
class TextScanner {
 public:
  explicit TextScanner(std::string_view text)
      : begin_(text.data()), at_(begin_), end_(begin_ + text.size()) {}

  /// The next number; false at the end or where no number stands (then the position is at that word). Words
  /// such as nan, nan(ind), 1.#QNAN and inf are numbers; one that no double can hold becomes zero or
  /// infinity.
  [[nodiscard]] bool number(double& value);
  [[nodiscard]] bool integer(std::int64_t& value);

  void skip_blanks() {
    while (at_ != end_ && (*at_ == ' ' || (*at_ >= '\t' && *at_ <= '\r'))) {
      ++at_;
    }
  }
  /// The rest of the line without its end; the position moves behind it.
  [[nodiscard]] std::string_view line(char end = '\n');
  [[nodiscard]] bool at_end() {
    skip_blanks();
    return at_ == end_;
  }
  /// The word at the position, shortened to what fits into a message.
  [[nodiscard]] std::string word_here();
  /// Line of the position, the first being 1.
  [[nodiscard]] std::size_t line_number() const;
  [[nodiscard]] std::size_t position() const { return static_cast<std::size_t>(at_ - begin_); }
  void seek(std::size_t position) { at_ = begin_ + position; }
  [[nodiscard]] std::size_t remaining() const { return static_cast<std::size_t>(end_ - at_); }

 private:
  [[nodiscard]] bool ends_word(const char* p) const {
    return p == end_ || *p == ' ' || (*p >= '\t' && *p <= '\r');
  }

  const char* begin_;
  const char* at_;
  const char* end_;
};

/// The text after the mark that some editors put before UTF-8.
[[nodiscard]] inline std::string_view without_byte_order_mark(std::string_view text) {
  return text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text;
}

/// Whether the lines of a text end in a carriage return alone, as those of an old Macintosh do.
[[nodiscard]] inline bool has_macintosh_lines(std::string_view text) {
  return text.contains('\r') && !text.contains('\n');
}
/// Such a text with line feeds instead.
[[nodiscard]] std::string with_line_feeds(std::string_view text);

/// The word between quotes, shortened to what fits into a message.
[[nodiscard]] std::string in_quotes(std::string_view word);

/// Words of one line, split at blanks.
[[nodiscard]] std::string_view take_word(std::string_view& line);

/// The whole word as a number; false when it is anything else.
[[nodiscard]] bool parse_number(std::string_view word, double& value);
/// The same, or with a comma in the place of the decimal point.
[[nodiscard]] bool parse_number_or_comma(std::string_view word, double& value);
[[nodiscard]] bool parse_integer(std::string_view word, std::int64_t& value);

}  // namespace dubsar
