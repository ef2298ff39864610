// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// session sign: a name under the verdict, once it has been worked out anew.

#include <cstdio>
#include <memory>

#include "core/log.h"
#include "formats/sign_off_json.h"
#include "station/command/option_checks.h"
#include "station/command/scan_warnings.h"
#include "station/command/session_verbs.h"
#include "station/sign_off_words.h"
#include "station/signing.h"

namespace dubsar {

namespace {

struct SignArguments {
  std::string path;
  std::string name;
  std::string role;
  std::string note;
  std::string incomplete;
};

/// It ran, but the session is not what may be signed: one line, and status 1.
int refuse(const Error& error, const CommandContext& context) {
  finish_progress();
  log_error(error.line());
  if (context.json) {
    CommandContext::print(error_json(error));
  }
  return 1;
}

Result<int> sign(const SignArguments& arguments, CommandContext& context) {
  SignOff wanted;
  wanted.name = arguments.name;
  wanted.role = arguments.role;
  wanted.note = arguments.note;
  wanted.incomplete = arguments.incomplete;
  const Result<Signing> signing = sign_verdict(arguments.path, std::move(wanted), context.job);
  if (!signing) {
    return std::unexpected(signing.error());
  }
  if (signing->refused) {
    return refuse(*signing->refused, context);
  }
  finish_progress();
  log_scan_warnings(signing->checklist.warnings);
  if (signing->no_pages) {
    log_warning("signed, but the pages could not be made: " + signing->no_pages->line());
  }
  const CheckedSignOff& made = *signing->checklist.sign_off;
  if (context.json) {
    CommandContext::print({{"session", arguments.path},
                           {"sign_off", sign_off_json(made)},
                           {"checklist", signing->page.string()}});
  } else {
    std::printf("%s\n  sha256    %s\n", sign_off_line(made).c_str(), made.sign_off.digest.c_str());
    if (!signing->page.empty()) {
      std::printf("  checklist %s\n", signing->page.c_str());
    }
  }
  return 0;
}

}  // namespace

void add_session_sign(CLI::App& session, Action& chosen) {
  CLI::App* verb = session.add_subcommand(
      "sign", "Put a name under the verdict; status 1 when there is none to sign, or it falls short");
  const auto arguments = std::make_shared<SignArguments>();
  const auto said = CLI::Validator(
      [](std::string& text) { return trimmed(text).empty() ? "says nothing" : std::string(); }, "TEXT");
  verb->add_option("session", arguments->path, "a session folder")->required();
  verb->add_option("--name", arguments->name, "who signs")
      ->required()
      ->check(said)
      ->check(single_line())
      ->check(readable());
  verb->add_option("--role", arguments->role, "as what")->check(single_line())->check(readable());
  verb->add_option("--note", arguments->note, "anything that a reader should know")->check(readable());
  verb->add_option("--incomplete", arguments->incomplete, "sign although it falls short, and why")
      ->check(said)
      ->check(single_line())
      ->check(readable());
  verb->fallthrough();
  verb->callback(
      [&chosen, arguments] { chosen = [arguments](CommandContext& c) { return sign(*arguments, c); }; });
}

}  // namespace dubsar
