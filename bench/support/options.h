// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// How every bench reads its words.
namespace dubsar::bench {

/// A number with a point that is one: "nan" is neither below nor above any limit, and passes every range. And
/// a number without a sign that has none: "-1" is read as the largest there is, and a bench would never end.
inline void refuse_what_is_no_number(CLI::App& app) {
  static const CLI::Validator kFinite(
      [](std::string& text) {
        double value = 0;
        return CLI::detail::lexical_cast(text, value) && std::isfinite(value) ? std::string()
                                                                              : "'" + text + "' is no number";
      },
      "");
  static const CLI::Validator kUnsigned(
      [](std::string& text) {
        return text.find('-') == std::string::npos ? std::string() : "'" + text + "' is below 0";
      },
      "");
  for (CLI::Option* option : app.get_options({})) {
    if (option->get_type_name().find(CLI::detail::type_name<double>()) != std::string::npos) {
      option->check(kFinite);
    }
    if (option->get_type_name().find(CLI::detail::type_name<std::uint64_t>()) != std::string::npos) {
      option->check(kUnsigned);
    }
  }
  for (CLI::App* verb : app.get_subcommands({})) {
    refuse_what_is_no_number(*verb);
  }
}

/// For a word that is one of these: any other would be taken for the first of them, or for none.
[[nodiscard]] inline CLI::IsMember one_of(std::span<const std::string_view> words) {
  return CLI::IsMember(std::vector<std::string>(words.begin(), words.end()));
}

/// Reads the words. A status where the bench is to end with it at once: 0 when help was asked for, and 2,
/// with one line, for wrong use.
[[nodiscard]] inline std::optional<int> ends_with(CLI::App& app, int argc, const char* const* argv) {
  refuse_what_is_no_number(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked_for_help) {
    return app.exit(asked_for_help);
  } catch (const CLI::ParseError& bad) {
    const std::string name = app.get_name().empty() ? std::string("bench") : app.get_name();
    std::fprintf(stderr, "%s: %s; see --help\n", name.c_str(), bad.what());
    return 2;
  }
  return std::nullopt;
}

}  // namespace dubsar::bench
