// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Completion of the command's words by bash and by zsh.

#include <algorithm>
#include <string_view>

#include "core/shell_word.h"
#include "station/command/reference.h"

namespace dubsar {

namespace {

/// "session undo" as part of the name of a function.
std::string identifier(const ReferenceVerb& verb) {
  std::string out = "_dubsar";
  for (const std::string& word : verb.words) {
    out += "_" + word;
  }
  std::ranges::replace(out, '-', '_');
  return out;
}

/// Options of the verb, then those of the command that it lacks: these are taken after any verb.
std::vector<ReferenceOption> all_options(const ReferenceVerb& verb, const ReferenceVerb& command) {
  std::vector<ReferenceOption> out = verb.options;
  for (const ReferenceOption& option : command.options) {
    const bool known = std::ranges::any_of(
        out, [&](const ReferenceOption& one) { return !one.names.empty() && one.names == option.names; });
    if (!known && option.names.back() != "--version") {
      out.push_back(option);
    }
  }
  return out;
}

/// `text` inside the brackets of a zsh specification.
std::string zsh_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') {
      out += '\\';
    }
    out += c;
  }
  return out;
}

std::string zsh_action(const ReferenceOption& option) {
  if (option.choices.empty()) {
    return option.word == "TEXT" ? "_files" : " ";
  }
  std::string out = "(";
  for (const std::string& choice : option.choices) {
    out += (out.size() == 1 ? "" : " ") + choice;
  }
  return out + ")";
}

void zsh_options(std::string& out, const std::vector<ReferenceOption>& options) {
  for (const ReferenceOption& option : options) {
    for (const std::string& name : option.names) {
      std::string spec = (option.repeats ? "*" : "") + name + "[" + zsh_text(option.help) + "]";
      if (!option.word.empty()) {
        spec += ":" + zsh_text(option.word) + ":" + zsh_action(option);
      }
      out += "    " + shell_word(spec) + " \\\n";
    }
  }
}

}  // namespace

std::string bash_completion(const std::vector<ReferenceVerb>& verbs) {
  // Which words of the line are verbs: each path, and what may follow it.
  std::string paths, options, values;
  for (const ReferenceVerb& verb : verbs) {
    const std::string path = shell_word(verb.path());
    std::string words;
    for (const ReferenceOption& option : all_options(verb, verbs.front())) {
      for (const std::string& name : option.names) {
        words += (words.empty() ? "" : " ") + name;
        if (!option.word.empty()) {
          std::string choices;
          for (const std::string& choice : option.choices) {
            choices += (choices.empty() ? "" : " ") + choice;
          }
          values += "    " + shell_word(verb.path() + " " + name) +
                    ") takes=1; choices=" + shell_word(choices) + " ;;\n";
        }
      }
    }
    if (verb.words.empty()) {
      words += " --version";
    }
    std::string below;
    for (const std::string& name : verb.verbs) {
      below += (below.empty() ? "" : " ") + name;
    }
    options += "    " + path + ") options=" + shell_word(words) + "; verbs=" + shell_word(below) + " ;;\n";
  }
  return "# bash completion for dubsar. Made by dubsar reference bash.\n"
         "_dubsar_value() {  # PATH OPTION: does it take a value, and which\n"
         "  takes=0; choices=\n"
         "  case \"$1 $2\" in\n" +
         values +
         "  esac\n"
         "}\n"
         "_dubsar_words() {  # PATH: its options and the verbs below it\n"
         "  options=; verbs=\n"
         "  case \"$1\" in\n" +
         options +
         "  esac\n"
         "}\n"
         R"(_dubsar() {
  local options verbs takes choices path='' word before='' i
  COMPREPLY=()
  local current="${COMP_WORDS[COMP_CWORD]}"
  _dubsar_words ''
  for ((i = 1; i < COMP_CWORD; ++i)); do
    word="${COMP_WORDS[i]}"
    if [[ $word == = ]]; then continue; fi
    if [[ -n $before ]]; then before=''; continue; fi
    if [[ $word == -* ]]; then
      _dubsar_value "$path" "$word"
      if ((takes)); then before="$word"; fi
    elif [[ " $verbs " == *" $word "* ]]; then
      path="${path:+$path }$word"
      _dubsar_words "$path"
    fi
  done
  if [[ $current == = ]]; then current=''; fi
  if [[ -n $before ]]; then
    _dubsar_value "$path" "$before"
    if [[ -n $choices ]]; then mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$current"); fi
  elif [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$current")
  elif [[ -n $verbs ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$verbs" -- "$current")
  fi
}
# Nothing of ours fits: names of files.
complete -o default -F _dubsar dubsar
)";
}

std::string zsh_completion(const std::vector<ReferenceVerb>& verbs) {
  std::string out = "#compdef dubsar\n# Made by dubsar reference zsh.\n";
  for (const ReferenceVerb& verb : verbs) {
    out += "\n" + identifier(verb) + "() {\n";
    if (!verb.verbs.empty()) {
      out += "  local curcontext=\"$curcontext\" state line\n  typeset -A opt_args\n";
    }
    out += std::string("  _arguments ") + (verb.verbs.empty() ? "" : "-C ") + "\\\n";
    zsh_options(out, verb.words.empty() ? verb.options : all_options(verb, verbs.front()));
    if (verb.verbs.empty()) {
      for (const ReferenceOption& option : verb.options) {
        if (option.names.empty()) {
          out += "    " +
                 shell_word((option.repeats ? "*:" : ":") + zsh_text(option.positional) + ":" +
                            zsh_action(option)) +
                 " \\\n";
        }
      }
      out += "    && return 0\n}\n";
      continue;
    }
    out +=
        "    '1: :->verb' '*:: :->rest' && return 0\n  case $state in\n    verb)\n      local -a verbs=(\n";
    for (std::size_t i = 0; i < verb.verbs.size(); ++i) {
      out += "        " + shell_word(verb.verbs[i] + ":" + zsh_text(verb.verb_helps[i])) + "\n";
    }
    out += "      )\n      _describe verb verbs ;;\n    rest)\n      case $line[1] in\n";
    for (const std::string& name : verb.verbs) {
      ReferenceVerb below = verb;
      below.words.push_back(name);
      out += "        " + name + ") " + identifier(below) + " ;;\n";
    }
    out += "      esac ;;\n  esac\n}\n";
  }
  return out + "\n_dubsar \"$@\"\n";
}

}  // namespace dubsar
