// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Sentences of the engine in the words of the window.
#include <algorithm>
#include <functional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "ui/shell/decimal_comma.h"
#include "ui/shell/engine_words.h"
#include "ui/shell/text_table.h"

namespace dubsar::ui {

namespace {

/// What the engine says to somebody at the command line, as the window says it.
constexpr std::pair<std::string_view, std::string_view> kInWindow[] = {
    {" (session restore puts it back)", " (a click on it puts it back)"},
    {"take the wrong ones out (session drop), then give the same command again",
     "take the wrong ones out, then go on"},
    {", then give the same command again", ", then go on"},
    {"; --max-scans allows more", ""},
    {"see what differs (dubsar verify), choose another folder, or replace it with --force",
     "see what differs, or choose another folder"},
    {"bring it up to date with --update, choose another folder, or replace it with --force",
     "choose another folder"},
    {", or replace it with --force", ""},
    {"a copy of the session (dubsar verify --repair --from COPY)", "a copy of the session"},
    {"run dubsar register and dubsar plan on it first", "go on and finish first"},
    {"run dubsar plan on it, read what it says, and sign again",
     "go on, finish, read what it says, and sign again"},
    {"sign it as it is with --incomplete REASON", "sign it as incomplete, with the reason"},
    {"see dubsar verify and bring back what is damaged", "bring back what is damaged"},
    {"dubsar mesh convert --unit mm mends the file", "export it again with millimetres as its unit"},
    {"dubsar mesh convert --unit ", "export it again in millimetres, not in "},
    {" makes millimetres of them", ""},
    {"dubsar drivers lists", "the list under Scanner shows"},
    {"see dubsar drivers", "see the list under Scanner"},
    {"give the right --unit", "give the right ?unit="},
    {" for a folder, or `obj_info", " behind the folder, or `obj_info"},
    {"--unit ", "?unit="},
    {"make it: dubsar calibrate PICTURES --board BOARD --rig ", "make it under Calibrate, for "},
    {"; measure the artefact first: dubsar calibrate --verify", "; measure the artefact first"},
    {", then dubsar calibrate --verify", ", then verify it again"},
    {"sign with --incomplete REASON", "sign it as incomplete, with the reason"},
    {"sign it without --incomplete; --note takes a remark", "sign it as it is; a note takes a remark"},
    {"run dubsar plan on it, read it, and sign again", "go on, finish, read it, and sign again"},
    {"run dubsar plan on it first", "go on and finish first"},
    {"see dubsar session list", "see the strip of scans"},
    {"say what the numbers are with --unit", "say what the numbers are with ?unit="},
    {"; scans become one with dubsar stitch", ""},
    {"give a folder with a calibration.toml, or with pictures of the board and --board",
     "give a folder with a calibration.toml, or with pictures of the board, and name the board"},
    {"give --board-exposure and --laser-exposure, both", "give both exposures, for board and laser"},
    {"say --motion linear or turntable", "choose linear or turntable"},
    {"write one, or say --board for", "write one, or name the board for"},
    {" with --on", ""},
};

template <class Pairs>
void replace_each(std::string& text, const Pairs& pairs) {
  for (const auto& [from, to] : pairs) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at)) {
      text.replace(at, std::string_view(from).size(), to);
      at += std::string_view(to).size();
    }
  }
}

}  // namespace

const std::vector<EnginePhrase>& engine_sentences() {
  static const std::vector<EnginePhrase> kSorted = [] {
    std::vector<EnginePhrase> all;
    for (const auto& table : {engine_turns(), engine_phrases(), engine_calibration(), engine_remarks(),
                              engine_cameras(), engine_controllers(), engine_rigs(), engine_drivers(),
                              engine_files(), engine_shapes(), engine_stored(), engine_packages()}) {
      all.insert(all.end(), table.begin(), table.end());
    }
    std::ranges::stable_sort(all, std::ranges::greater(),
                             [](const EnginePhrase& one) { return std::string_view(one.english).size(); });
    return all;
  }();
  return kSorted;
}

namespace {

std::string german_of(const std::string& english) {
  for (const auto& whole : {engine_stages(), engine_settings(), engine_options()}) {
    for (const auto& [from, to] : whole) {
      if (english == from) {
        return to;
      }
    }
  }
  std::string out = with_german_names(english);
  replace_each(out, engine_sentences());
  return with_decimal_commas(with_german_numbers(out));
}

}  // namespace

std::string translated(const std::string& english, Language language) {
  if (language == Language::kEnglish) {
    std::string out = english;
    replace_each(out, kInWindow);
    return out;
  }
  // The window asks for the same few sentences in every picture that it draws.
  constexpr std::size_t kMostKept = 500;
  thread_local std::unordered_map<std::string, std::string> kept;
  if (kept.size() > kMostKept) {
    kept.clear();
  }
  const auto [said, is_new] = kept.try_emplace(english);
  if (is_new) {
    said->second = german_of(english);
  }
  return said->second;
}

std::string translated(const Error& error, Language language) {
  // Where it is may be any file's or device's name.
  const bool is_name = error.where.find_first_of("/:.") != std::string::npos;
  const auto in_words = [language](const std::string& text) { return translated(text, language); };
  return Error{error.kind, in_words(error.what), is_name ? error.where : in_words(error.where),
               in_words(error.mend)}
      .line();
}

}  // namespace dubsar::ui
