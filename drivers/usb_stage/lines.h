// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace dubsar::usb_stage {

/// Makes lines of bytes as they come. Whatever is no text becomes '?'; a line that never ends is cut.
class LineSplitter {
 public:
  static constexpr std::size_t kLongest = 512;

  void add(std::string_view bytes) {
    for (const char c : bytes) {
      if (c == '\n' || c == '\r' || current_.size() == kLongest) {
        end_line();
      }
      if (c != '\n' && c != '\r') {
        current_ += c >= ' ' && c <= '~' ? c : '?';
      }
    }
  }
  /// The oldest whole line, without its end; empty lines are left out.
  std::optional<std::string> next() {
    const std::size_t end = whole_.find('\n');
    if (end == std::string::npos) {
      return std::nullopt;
    }
    std::string out = whole_.substr(0, end);
    whole_.erase(0, end + 1);
    return out;
  }
  void clear() {
    current_.clear();
    whole_.clear();
  }

 private:
  void end_line() {
    constexpr std::size_t kMostWaiting = 64 * kLongest;  // of a firmware that babbles
    if (!current_.empty() && whole_.size() < kMostWaiting) {
      whole_ += current_ + '\n';
    }
    current_.clear();
  }
  std::string current_, whole_;
};

}  // namespace dubsar::usb_stage
