// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/command/wrong_words.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "station/command/option_checks.h"

namespace dubsar {

namespace {

/// The last verb that the parser knew: of the program, or of another verb.
const CLI::App& chosen_verb(const CLI::App& app) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  return chosen.empty() ? app : chosen_verb(*chosen.front());
}

/// Letters to change, add or leave out (Levenshtein).
std::size_t letters_apart(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

}  // namespace

std::optional<Error> unknown_verb(const CLI::App& app) {
  constexpr std::size_t kSlips = 2;
  const CLI::App& verb = chosen_verb(app);
  const std::vector<const CLI::App*> known = verb.get_subcommands([](const CLI::App*) { return true; });
  const std::vector<std::string> rest = app.remaining(true);
  const auto word = std::ranges::find_if(rest, [](const std::string& w) { return !w.starts_with('-'); });
  if (known.empty() || (word == rest.end() && !rest.empty())) {
    return std::nullopt;
  }
  std::string all;
  for (const CLI::App* one : known) {
    all += (all.empty() ? "there are: " : ", ") + one->get_name();
  }
  const std::string within = &verb == &app ? "" : verb.get_name();
  if (rest.empty() || word->empty()) {
    return Error{ErrorKind::kUsage, "a verb is missing", within, all};
  }
  std::size_t least = std::min(kSlips + 1, word->size());
  const CLI::App* meant = nullptr;
  for (const CLI::App* one : known) {
    if (const std::size_t apart = letters_apart(*word, one->get_name()); apart < least) {
      least = apart;
      meant = one;
    }
  }
  return Error{ErrorKind::kUsage, "there is no verb " + *word, within,
               meant == nullptr ? all : "do you mean " + meant->get_name() + "?"};
}

std::optional<Error> empty_option(const CLI::App& app) {
  for (const CLI::App* verb : app.get_subcommands()) {
    for (const CLI::Option* option : verb->get_options()) {
      if (option->count() > 0 && !option->get_type_name().starts_with(kMayBeEmpty) &&
          std::ranges::find(option->results(), "") != option->results().end()) {
        return Error{ErrorKind::kUsage, "nothing is said", option->get_name(), "give it a text"};
      }
    }
    if (std::optional<Error> deeper = empty_option(*verb)) {
      return deeper;
    }
  }
  return std::nullopt;
}

}  // namespace dubsar
