// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar reference: what the parser knows of itself, as a manual page or as a shell's completion. Packages
// are made with it; it is not listed in --help, for an operator has no use for it.

#include "station/command/reference.h"

#include <cstdio>
#include <memory>

namespace dubsar {

namespace {

std::string joined(const std::vector<std::string>& words, const char* between) {
  std::string out;
  for (const std::string& word : words) {
    out += (out.empty() ? "" : between) + word;
  }
  return out;
}

/// The values of "TEXT:{surface,extent}", or none.
std::vector<std::string> choices_of(const std::string& type) {
  const std::size_t open = type.find('{');
  const std::size_t close = type.rfind('}');
  if (open == std::string::npos || close == std::string::npos || close < open) {
    return {};
  }
  std::vector<std::string> out(1);
  for (const char c : type.substr(open + 1, close - open - 1)) {
    if (c == ',') {
      out.emplace_back();
    } else {
      out.back() += c;
    }
  }
  return out;
}

ReferenceOption option_of(const CLI::Option& option) {
  ReferenceOption out;
  for (const std::string& name : option.get_snames()) {
    out.names.push_back("-" + name);
  }
  for (const std::string& name : option.get_lnames()) {
    out.names.push_back("--" + name);
  }
  if (!option.nonpositional()) {
    out.positional = option.get_name(true);
  }
  out.help = option.get_description();
  out.required = option.get_required();
  if (option.get_items_expected_max() > 0) {  // not a flag
    const std::string type = option.get_type_name();
    out.word = type.substr(0, type.find(':'));
    out.choices = choices_of(type);
    if (const std::size_t colon = type.find(':'); colon != std::string::npos && out.choices.empty()) {
      out.bounds = type.substr(colon + 1);
    }
    out.standard = option.get_default_str();
    out.repeats = option.get_items_expected_max() > 1;
  }
  return out;
}

void collect(const CLI::App& app, const std::vector<std::string>& words, std::vector<ReferenceVerb>& out) {
  ReferenceVerb verb{words, app.get_description(), {}, {}, {}};
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_group().empty()) {
      verb.options.push_back(option_of(*option));
    }
  }
  const auto shown = app.get_subcommands([](const CLI::App* sub) { return !sub->get_group().empty(); });
  for (const CLI::App* sub : shown) {
    verb.verbs.push_back(sub->get_name());
    verb.verb_helps.push_back(sub->get_description());
  }
  out.push_back(std::move(verb));
  for (const CLI::App* sub : shown) {
    std::vector<std::string> path = words;
    path.push_back(sub->get_name());
    collect(*sub, path, out);
  }
}

}  // namespace

std::string ReferenceVerb::path() const {
  return joined(words, " ");
}

std::vector<ReferenceVerb> reference_of(const CLI::App& app) {
  std::vector<ReferenceVerb> out;
  collect(app, {}, out);
  return out;
}

void add_reference(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand("reference", "The manual page, or a shell's completion of the command");
  verb->group("");
  const auto what = std::make_shared<std::string>();
  verb->add_option("what", *what, "man, bash or zsh")
      ->required()
      ->check(CLI::IsMember({"man", "bash", "zsh"}));
  verb->callback([&chosen, &app, what] {
    chosen = [&app, what](CommandContext& context) -> Result<int> {
      const std::vector<ReferenceVerb> verbs = reference_of(app);
      const std::string text = *what == "man"    ? manual_page(verbs, DUBSAR_VERSION)
                               : *what == "bash" ? bash_completion(verbs)
                                                 : zsh_completion(verbs);
      if (context.json) {
        CommandContext::print({{"what", *what}, {"text", text}});
      } else {
        std::fputs(text.c_str(), stdout);
      }
      return 0;
    };
  });
}

}  // namespace dubsar
