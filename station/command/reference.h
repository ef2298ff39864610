// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

#include "station/command/command.h"

namespace dubsar {

/// One option or positional word of a verb, as its parser knows it.
struct ReferenceOption {
  std::vector<std::string> names;    ///< "-o", "--out"; empty for a positional word
  std::string word;                  ///< what stands for its value ("TEXT"); empty for a flag
  std::vector<std::string> choices;  ///< the only values that it takes; empty: any
  std::string help;
  std::string positional;  ///< the name of a positional word
  std::string bounds;      ///< "INT in [1 - 100]"
  std::string standard;    ///< the value when it is not given
  bool required = false;
  bool repeats = false;  ///< takes more than one value
};

/// A verb ("session undo") or, with no words, the command itself.
struct ReferenceVerb {
  std::vector<std::string> words;
  std::string help;
  std::vector<ReferenceOption> options;
  std::vector<std::string> verbs;       ///< the last words of the verbs below it
  std::vector<std::string> verb_helps;  ///< one for each of `verbs`

  [[nodiscard]] std::string path() const;  ///< "session undo"
};

/// Every verb that --help shows, the command itself first, in the order of --help. The manual page and the
/// completions are made from this, so that they cannot say anything else than the parser does.
[[nodiscard]] std::vector<ReferenceVerb> reference_of(const CLI::App& app);

/// The manual page dubsar(1), for man(7).
[[nodiscard]] std::string manual_page(const std::vector<ReferenceVerb>& verbs, const std::string& version);
/// What bash sources to complete the command's words; needs nothing beside bash.
[[nodiscard]] std::string bash_completion(const std::vector<ReferenceVerb>& verbs);
/// The function `_dubsar` of zsh's completion system.
[[nodiscard]] std::string zsh_completion(const std::vector<ReferenceVerb>& verbs);

}  // namespace dubsar
