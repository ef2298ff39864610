// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/support/options.h"

namespace dubsar::bench {

/// What dubsar-drivers is asked for.
struct DriverWords {
  std::string what;
  std::string scheme;
  std::uint64_t count = 0;
  int rate_hz = 400;
  std::string size = "640x480";
  std::vector<std::pair<std::string, std::string>> options;  ///< of the driver

  /// A status where the bench is to end with it at once.
  [[nodiscard]] std::optional<int> read(int argc, const char* const* argv) {
    std::vector<std::string> own;
    CLI::App app("The drivers of devices against the emulated ones of the tests", "dubsar-drivers");
    app.add_option("what", what)->required()->check(CLI::IsMember({"frames", "unplug"}));
    app.add_option("scheme", scheme)->required()->check(CLI::IsMember({"v4l2", "aravis", "usb_stage"}));
    app.add_option("count", count, "frames or positions (100000), or pulls (100)")
        ->check(CLI::Range(1, 1000000000));
    app.add_option("rate", rate_hz, "Hz")->check(CLI::Range(1, 100000));
    app.add_option("size", size, "WIDTHxHEIGHT")->check(CLI::Validator(is_size, ""));
    app.add_option("options", own, "OPTION=VALUE of the driver");
    if (const auto status = ends_with(app, argc, argv)) {
      return status;
    }
    count = count > 0 ? count : what == "frames" ? 100000 : 100;
    for (const std::string& word : own) {
      const std::size_t sign = word.find('=');
      options.emplace_back(word.substr(0, sign), sign == word.npos ? "1" : word.substr(sign + 1));
    }
    return std::nullopt;
  }

 private:
  static std::string is_size(const std::string& text) {
    const std::size_t by = text.find('x');
    const auto is_number = [](const std::string& digits) {
      return !digits.empty() && digits.size() < 6 && digits.find_first_not_of("0123456789") == digits.npos;
    };
    const bool fits = by != text.npos && is_number(text.substr(0, by)) && is_number(text.substr(by + 1));
    return fits ? std::string() : "'" + text + "' is no WIDTHxHEIGHT";
  }
};

}  // namespace dubsar::bench
