// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The manual page and the completions say what --help says of every verb, and no verb is left out.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>

#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using test::Arguments;
using test::run_command;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

struct Helped {
  Arguments words;
  std::vector<std::string> options;  ///< as --help names them, long where there is a long name
  std::vector<std::string> verbs;
};

/// What --help prints of a verb and of all below it.
void collect(const Arguments& words, std::vector<Helped>& out) {
  Arguments asked = words;
  asked.emplace_back("--help");
  std::istringstream lines(run_command(asked).out);
  Helped here{words, {}, {}};
  bool options = false;
  bool verbs = false;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(' ')) {
      options = line == "Options:";
      verbs = line == "Subcommands:";
    } else if (line.size() > 2 && line[2] != ' ') {
      const std::string name = line.substr(2, line.find(' ', 2) - 2);
      if (verbs) {
        here.verbs.push_back(name);
      } else if (options && name != "-h,--help") {
        here.options.push_back(name.substr(name.find(',') + 1));
      }
    }
  }
  out.push_back(here);
  for (const std::string& verb : here.verbs) {
    Arguments below = words;
    below.push_back(verb);
    collect(below, out);
  }
}

const std::vector<Helped>& everything() {
  static const std::vector<Helped> found = [] {
    std::vector<Helped> out;
    collect({}, out);
    return out;
  }();
  return found;
}

std::string dashes_escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '-') {
      out += '\\';
    }
    out += c;
  }
  return out;
}

std::string path_of(const Arguments& words) {
  std::string out;
  for (const std::string& word : words) {
    out += (out.empty() ? "" : " ") + word;
  }
  return out;
}

TEST(Reference, HelpIsReadRight) {
  ASSERT_THAT(everything().front().verbs, Contains("scan"));
  EXPECT_GT(everything().size(), 25U);
  EXPECT_THAT(everything().front().options, Contains("--json"));
}

TEST(Reference, ManualPageNamesEveryVerbAndOption) {
  const test::Outcome page = run_command({"reference", "man"});
  ASSERT_EQ(page.status, 0) << page.err;
  for (const Helped& verb : everything()) {
    const std::string head =
        verb.words.empty() ? ".SH OPTIONS\n" : ".SS " + dashes_escaped(path_of(verb.words)) + "\n";
    const std::size_t begin = page.out.find(head);
    ASSERT_NE(begin, std::string::npos) << head;
    const std::string section = page.out.substr(begin, page.out.find("\n.S", begin + head.size()) - begin);
    for (const std::string& option : verb.options) {
      EXPECT_THAT(section, HasSubstr("\\fB" + dashes_escaped(option) + "\\fR")) << head;
    }
  }
  EXPECT_THAT(page.out, HasSubstr(".SH \"EXIT STATUS\""));
  EXPECT_THAT(page.out, Not(HasSubstr("\nRequired."))) << "that is no description";
}

TEST(Reference, HelpSaysWhatIsTakenWhereNothingIsSaid) {
  const std::vector<std::pair<Arguments, const char*>> said{
      {{"simulate", "tablet"}, "--text FLOAT:FLOAT in [0 - 1]=1"},
      {{"simulate", "tablet"}, "--holes FLOAT:FLOAT in [0 - 1]=0"},
      {{"simulate", "tablet"}, "--damage FLOAT:FLOAT in [0 - 1]=0.3"},
      {{"pins"}, "--count INT:INT in [3 - 15]=15"},
      {{"pins"}, "--triangulation FLOAT:FLOAT in [0 - 80]=24"},
      {{"search"}, "--count INT:INT in [1 - 100000]=10"},
      {{"calibrate"}, "--stops INT:INT in [3 - 50]=5"},
      {{"view"}, "--width INT:INT in [640 - 16384]=1366"},
      {{"view"}, "--height INT:INT in [480 - 16384]=768"},
      {{"scan"}, "default: 40 with --auto"},
  };
  for (const auto& [verb, words] : said) {
    Arguments asked = verb;
    asked.emplace_back("--help");
    EXPECT_THAT(run_command(asked).out, HasSubstr(words));
  }
}

/// What bash offers after `words`, one answer a line of each, in order.
std::vector<std::vector<std::string>> completed(const std::vector<Arguments>& lines) {
  const test::TemporaryFolder folder;
  const auto completion = folder.path() / "completion";
  const auto script = folder.path() / "script";
  std::ofstream(completion) << run_command({"reference", "bash"}).out;
  std::ofstream commands(script);
  commands << "set -eu\n. '" << completion.string() << "'\n";
  for (const Arguments& line : lines) {
    commands << "COMP_WORDS=(dubsar";
    for (const std::string& word : line) {
      commands << " '" << word << "'";
    }
    commands << ")\nCOMP_CWORD=" << line.size() << "\n_dubsar\necho \"${COMPREPLY[@]+${COMPREPLY[@]}}\"\n";
  }
  commands.close();
  const auto closer = [](FILE* pipe) { pclose(pipe); };
  const std::unique_ptr<FILE, decltype(closer)> pipe(
      popen(("bash '" + script.string() + "' 2>&1").c_str(), "r"), closer);
  std::string said;
  std::array<char, 4096> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe.get()) != nullptr) {
    said += buffer.data();
  }
  std::vector<std::vector<std::string>> out;
  std::istringstream answers(said);
  for (std::string answer; std::getline(answers, answer);) {
    std::istringstream words(answer);
    out.emplace_back();
    for (std::string word; words >> word;) {
      out.back().push_back(word);
    }
  }
  return out;
}

TEST(Reference, BashOffersEveryVerbAndOption) {
  std::vector<Arguments> asked;
  for (const Helped& verb : everything()) {
    asked.push_back(verb.words);
    asked.back().emplace_back("");
    asked.push_back(verb.words);
    asked.back().emplace_back("--");
  }
  const auto offered = completed(asked);
  ASSERT_THAT(offered, SizeIs(asked.size()));
  for (std::size_t i = 0; i < everything().size(); ++i) {
    const Helped& verb = everything()[i];
    EXPECT_EQ(offered[2 * i], verb.verbs) << path_of(verb.words);
    for (const std::string& option : verb.options) {
      if (option.starts_with("--")) {
        EXPECT_THAT(offered[2 * i + 1], Contains(option)) << path_of(verb.words);
      }
    }
    EXPECT_THAT(offered[2 * i + 1], Contains("--json")) << path_of(verb.words);
  }
}

TEST(Reference, BashKnowsWhichWordsAreValues) {
  const auto offered = completed({
      {"analyze", "--exit", ""},             // the only values it takes
      {"analyze", "--exit", "=", "e"},       // as bash parts --exit=e
      {"analyze", "--out", "scan", "--ex"},  // a value that looks like a verb
      {"--json", "session", "un"},           // an option before the verb
      {"analyze", "-o", ""},                 // any file: bash's own words
  });
  ASSERT_THAT(offered, SizeIs(5));
  EXPECT_EQ(offered[0], (std::vector<std::string>{"surface", "extent"}));
  EXPECT_EQ(offered[1], (std::vector<std::string>{"extent"}));
  EXPECT_EQ(offered[2], (std::vector<std::string>{"--exit"}));
  EXPECT_EQ(offered[3], (std::vector<std::string>{"undo", "unlock"}));
  EXPECT_THAT(offered[4], SizeIs(0));
}

TEST(Reference, ZshHasAFunctionForEveryVerb) {
  const test::Outcome said = run_command({"reference", "zsh"});
  ASSERT_EQ(said.status, 0) << said.err;
  EXPECT_TRUE(said.out.starts_with("#compdef dubsar\n"));
  for (const Helped& verb : everything()) {
    std::string name = "_dubsar";
    for (const std::string& word : verb.words) {
      name += "_" + word;
    }
    const std::size_t begin = said.out.find("\n" + name + "() {\n");
    ASSERT_NE(begin, std::string::npos) << name;
    const std::string body = said.out.substr(begin, said.out.find("\n}\n", begin) - begin);
    for (const std::string& option : verb.options) {
      EXPECT_THAT(body, HasSubstr(option + "[")) << name;
    }
  }
}

}  // namespace
}  // namespace dubsar
