// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "formats/colour_values.h"
#include "formats/comma_use.h"
#include "formats/scan_samples.h"
#include "formats/text_scanner.h"
#include "formats/text_scans.h"

namespace dubsar {

namespace {

constexpr std::size_t kMaxColumns = 16;
/// Words may stand above the numbers, but not a whole document.
constexpr std::size_t kMaxLeadingLines = 64;
constexpr std::size_t kAskEvery = 4096;  ///< lines

struct Line {
  std::array<double, kMaxColumns> values{};
  std::size_t count = 0;
  bool blank = true;       ///< nothing, or a comment
  std::string_view stray;  ///< the first word that is no number
};

bool is_separator(char c) {
  return c == ' ' || c == ';' || (c >= '\t' && c <= '\r');
}

bool is_separator_or_comma(char c) {
  return is_separator(c) || c == ',';
}

Line read_line(std::string_view text, bool decimal_commas) {
  Line line;
  const auto ends_word = decimal_commas ? is_separator : is_separator_or_comma;
  const auto parse = decimal_commas ? parse_number_or_comma : parse_number;
  auto at = text.begin();
  while (line.count < kMaxColumns) {
    at = std::find_if_not(at, text.end(), ends_word);
    if (at == text.end()) {
      break;
    }
    const auto stop = std::find_if(at, text.end(), ends_word);
    const std::string_view word(at, stop);
    if (word.starts_with('#') || word.starts_with("//")) {
      break;
    }
    line.blank = false;
    if (!parse(word, line.values[line.count])) {
      line.stray = word.substr(0, 24);
      break;
    }
    ++line.count;
    at = stop;
  }
  return line;
}

/// What the three columns from `first` are, judged by all of them.
enum class Triple { kNone, kColour, kShares, kNormal };

Triple judge(const std::vector<float>& triples) {
  bool colour = true;
  bool share = true;  // of the brightest, as some programs write colours
  bool normal = true;
  bool above_one = false;
  for (std::size_t i = 0; i + 2 < triples.size(); i += 3) {
    float square = 0;
    for (std::size_t k = i; k < i + 3; ++k) {
      colour = colour && triples[k] >= 0 && triples[k] <= 255 && triples[k] == std::floor(triples[k]);
      share = share && triples[k] >= 0 && triples[k] <= 1;
      above_one = above_one || triples[k] > 1;
      square += triples[k] * triples[k];
    }
    normal = normal && std::abs(square - 1) < 0.02F;
  }
  if (colour && (above_one || !normal)) {
    return Triple::kColour;
  }
  return normal ? Triple::kNormal : share ? Triple::kShares : Triple::kNone;
}

}  // namespace

std::size_t count_point_lines(std::string_view head) {
  if (has_macintosh_lines(head)) {
    return count_point_lines(with_line_feeds(head));
  }
  std::size_t count = 0;
  TextScanner text(head);
  for (std::size_t number = 1; text.remaining() > 0; ++number) {
    // Whatever its commas are: with decimal ones it has three words or more.
    const Line line = read_line(text.line(), false);
    count += line.count >= 3 && line.stray.empty() ? 1 : 0;
    if (count == 0 && number > kMaxLeadingLines) {
      break;  // as it is read: no list of points begins so late
    }
  }
  return count;
}

Result<ScanData> read_point_text(std::string_view bytes, const std::string& name,
                                 const GridReadOptions& options) {
  if (bytes.empty()) {
    return bad_input(name, "the file is empty", "copy or export it again");
  }
  if (has_macintosh_lines(bytes)) {
    return read_point_text(with_line_feeds(bytes), name, options);
  }
  const double mm = options.mm_per_unit.value_or(1.0);
  TextScanner text(bytes);
  ScanSamples samples;
  std::vector<float> triples;
  std::size_t columns = 0;
  CommaReading commas;
  for (std::size_t number = 1; text.remaining() > 0; ++number) {
    if (number % kAskEvery == 0 && options.job != nullptr && options.job->cancelled()) {
      return fail(ErrorKind::kCancelled, "reading was stopped", name);
    }
    const std::string_view whole = text.line();
    bool decimal_commas = false;
    if (whole.contains(',')) {
      const Result<bool> told = commas.decimal(whole, bytes.substr(text.position()), number, name);
      if (!told) {
        return std::unexpected(told.error());
      }
      decimal_commas = *told;
    }
    const Line line = read_line(whole, decimal_commas);
    if (line.blank) {
      continue;
    }
    const bool is_sample = line.count >= 3 && line.stray.empty();
    if (!is_sample && columns == 0 && number <= kMaxLeadingLines) {
      continue;  // words above the numbers, or the count of points
    }
    if (!is_sample || line.count < columns) {
      return bad_input(
          name,
          "line " + std::to_string(number) + ": " +
              (line.stray.empty() ? "has " + std::to_string(line.count) + " numbers where " +
                                        std::to_string(std::max<std::size_t>(columns, 3)) + " belong"
                                  : in_quotes(line.stray) + " is not a number"),
          "export the points as text again");
    }
    columns = columns == 0 ? line.count : columns;
    samples.add(mm * line.values[0], mm * line.values[1], mm * line.values[2]);
    if (columns == 4 || columns == 7) {
      samples.intensity.push_back(static_cast<float>(line.values[3]));
    }
    for (std::size_t k = columns - 3; (columns == 6 || columns == 7) && k < columns; ++k) {
      triples.push_back(static_cast<float>(line.values[k]));
    }
  }
  if (!triples.empty()) {
    const Triple kind = judge(triples);
    if (kind == Triple::kColour || kind == Triple::kShares) {
      samples.rgb.reserve(triples.size());
      for (const float value : triples) {
        samples.rgb.push_back(colour_byte(kind == Triple::kShares ? value : value / 255.0));
      }
    } else if (kind == Triple::kNormal) {
      samples.normals = std::move(triples);
    }
  }
  if (const Status near = samples.check_place(name); !near) {
    return std::unexpected(near.error());
  }
  PointCloud cloud = cloud_from_samples(samples);
  if (cloud.points.empty()) {
    return bad_input(name, "holds no usable point", "export the points as lines of x y z");
  }
  cloud.source = file_name_of(name);
  return cloud;
}

}  // namespace dubsar
