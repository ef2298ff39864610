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

/// More is another word.
constexpr std::size_t kSlips = 2;

/// The verb with those that it belongs to: "dubsar mesh check".
std::string whole_name(const CLI::App& verb) {
  return verb.get_parent() == nullptr ? verb.get_name()
                                      : whole_name(*verb.get_parent()) + " " + verb.get_name();
}

/// -5 and -.5 are numbers, and - alone is a file's name.
bool is_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && word[1] != '.' && (word[1] < '0' || word[1] > '9') &&
         word != "--";
}

/// "--unit" of "--unit=m"
std::string option_name(const std::string& word) {
  return word.substr(0, word.find('='));
}

/// As they are written, of the verb and of those that it belongs to.
std::vector<std::string> option_names(const CLI::App& verb) {
  std::vector<std::string> names;
  for (const CLI::App* app = &verb; app != nullptr; app = app->get_parent()) {
    for (const CLI::Option* option : app->get_options()) {
      for (const std::string& name : option->get_lnames()) {
        names.push_back("--" + name);
      }
      for (const std::string& name : option->get_snames()) {
        names.push_back("-" + name);
      }
    }
  }
  return names;
}

}  // namespace

std::optional<Error> unknown_option(const CLI::App& app) {
  const CLI::App& verb = chosen_verb(app);
  const std::vector<std::string> rest = app.remaining(true);
  const auto word = std::ranges::find_if(rest, is_option);
  if (word == rest.end()) {
    return std::nullopt;
  }
  const std::string name = option_name(*word);
  std::size_t least = std::min(kSlips + 1, name.size() - 1);
  std::string meant;
  for (const std::string& one : option_names(verb)) {
    if (const std::size_t apart = letters_apart(name, one); one.size() > 2 && apart < least) {
      least = apart;
      meant = one;
    }
  }
  return Error{ErrorKind::kUsage, "there is no option " + name, whole_name(verb),
               meant.empty() ? "see " + whole_name(verb) + " --help" : "do you mean " + meant + "?"};
}

std::optional<Error> surplus_words(const CLI::App& app) {
  std::string all;
  for (const std::string& word : app.remaining(true)) {
    all += (all.empty() ? "" : " ") + word;
  }
  if (all.empty()) {
    return std::nullopt;
  }
  const std::string verb = whole_name(chosen_verb(app));
  return Error{ErrorKind::kUsage, "nothing is known of: " + all, verb, "see " + verb + " --help"};
}

std::string subject_of(const CLI::App& app) {
  const CLI::App& verb = chosen_verb(app);
  for (const CLI::Option* option : verb.get_options()) {
    if (option->get_positional() && option->count() > 0) {
      return option->results().front();
    }
  }
  const CLI::Option* out = verb.get_option_no_throw("--out");
  return out != nullptr && out->count() > 0 ? out->results().front() : whole_name(verb);
}

std::optional<Error> unknown_verb(const CLI::App& app) {
  const CLI::App& verb = chosen_verb(app);
  const std::vector<const CLI::App*> known = verb.get_subcommands([](const CLI::App*) { return true; });
  const std::vector<std::string> rest = app.remaining(true);
  const auto word = std::ranges::find_if(rest, [](const std::string& w) { return !w.starts_with('-'); });
  if (known.empty() || (word == rest.end() && !rest.empty())) {
    return std::nullopt;
  }
  std::string all;
  for (const CLI::App* one : known) {
    if (!one->get_group().empty()) {  // others are for those who make packages
      all += (all.empty() ? "there are: " : ", ") + one->get_name();
    }
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
