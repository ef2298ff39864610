// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/ptx_samples.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dubsar {

namespace {

constexpr std::size_t kCoordinates = 3;
constexpr std::size_t kMostColumns = 7;
constexpr std::size_t kAskEvery = 4096;  ///< samples

/// The numbers of a line: up to one more than belong there.
struct Numbers {
  std::array<double, kMostColumns + 1> value{};
  std::size_t count = 0;
  bool stray = false;  ///< a word that is no number stands behind them
  TextScanner text;    ///< there

  explicit Numbers(std::string_view line) : text(line) {
    while (count < value.size() && !stray && !text.at_end()) {
      stray = !text.number(value[count]);
      count += stray ? 0 : 1;
    }
  }
  [[nodiscard]] bool returned() const {
    return (value[0] != 0 || value[1] != 0 || value[2] != 0) && std::isfinite(value[0]) &&
           std::isfinite(value[1]) && std::isfinite(value[2]);
  }
  /// Whether what stands behind x y z can be a colour.
  [[nodiscard]] bool has_colour() const {
    return std::all_of(value.begin() + kCoordinates, value.begin() + 2 * kCoordinates,
                       [](double v) { return v >= 0 && v <= 255 && v == std::floor(v); });
  }
};

bool are_columns(std::size_t count) {
  return count == 3 || count == 4 || count == 6 || count == 7;
}

/// What is wrong with a line; `columns` is 0 before the first return. Empty: nothing.
std::string fault_of(const Numbers& line, std::size_t columns) {
  if (line.returned() && columns == 0) {
    return "a sample has " + std::to_string(line.count) + " numbers, not 3, 4, 6 or 7";
  }
  const std::size_t most = columns == 0 ? kMostColumns : columns;
  if (line.count < kCoordinates || line.count > most || (line.returned() && line.count != columns)) {
    return "has " + std::to_string(line.count) + " numbers where " +
           std::to_string(columns == 0 ? kCoordinates : columns) + " belong";
  }
  // Three numbers that might as well be a normal are not guessed at.
  return columns == 6 && !line.has_colour() ? "the last three of its 6 numbers are no colour" : "";
}

/// The columns behind x y z; those that a no-return leaves out are 0.
void add_rest(const Numbers& line, std::size_t columns, ScanSamples& samples) {
  if (columns == 4 || columns == 7) {
    samples.intensity.push_back(static_cast<float>(line.value[kCoordinates]));
  }
  for (std::size_t k = columns - 3; columns >= 6 && k < columns; ++k) {
    const double value = line.value[k];
    samples.rgb.push_back(value > 0 ? static_cast<std::uint8_t>(std::min(value, 255.0)) : std::uint8_t{0});
  }
}

}  // namespace

std::unexpected<Error> ptx_error(const TextScanner& text, const std::string& name, const std::string& what) {
  return bad_input(name, "line " + std::to_string(text.line_number()) + ": " + what, kNoPtxMend);
}

Result<ScanSamples> read_ptx_samples(TextScanner& text, char line_end, std::size_t cells, double mm,
                                     const std::string& name, const JobContext* job) {
  ScanSamples samples;
  samples.x.reserve(cells);  // the file has at least as many bytes
  samples.y.reserve(cells);
  samples.z.reserve(cells);
  samples.usable.reserve(cells);
  std::size_t columns = 0;
  for (std::size_t i = 0; i < cells; ++i) {
    if (i % kAskEvery == 0 && job != nullptr && job->cancelled()) {
      return fail(ErrorKind::kCancelled, "reading was stopped", name);
    }
    text.skip_blanks();
    const std::size_t start = text.position();
    Numbers line(text.line(line_end));
    if (line.stray) {
      text.seek(start);
      return ptx_error(
          text, name,
          "sample " + std::to_string(i) + ": " + in_quotes(line.text.word_here()) + " is not a number");
    }
    const bool returned = line.returned();
    if (columns == 0 && returned && are_columns(line.count)) {
      columns = line.count;
      samples.intensity.reserve(columns == 4 || columns == 7 ? cells : 0);
      samples.intensity.resize(columns == 4 || columns == 7 ? samples.size() : 0);
      samples.rgb.reserve(columns >= 6 ? 3 * cells : 0);
      samples.rgb.resize(columns >= 6 ? 3 * samples.size() : 0);
    }
    const bool plain = line.count == columns && columns != 6;
    if (const std::string fault = plain ? std::string() : fault_of(line, columns); !fault.empty()) {
      if (line.count < std::max(columns, kCoordinates) && text.at_end()) {
        return ptx_error(text, name, "ends at sample " + std::to_string(i) + " of " + std::to_string(cells));
      }
      text.seek(start);
      return ptx_error(text, name, fault);
    }
    samples.add(mm * line.value[0], mm * line.value[1], mm * line.value[2], returned);
    if (columns > kCoordinates) {
      add_rest(line, columns, samples);
    }
  }
  return samples;
}

}  // namespace dubsar
