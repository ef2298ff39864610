// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar verify: is every stored byte what was stored?

#include <cstdio>
#include <filesystem>
#include <memory>

#include "acquisition/session_store.h"
#include "acquisition/sign_off_log.h"
#include "formats/grid_file.h"
#include "formats/sign_off_json.h"
#include "station/command/command.h"
#include "station/command/sign_off_words.h"

namespace dubsar {

namespace {

int print_report(const std::string& path, const VerifyReport& report, const SignOffLog& signed_off,
                 bool as_json) {
  // An older sign-off that a later one stands beside is history; the latest one has to hold.
  const bool signature_good =
      signed_off.damage.empty() && (signed_off.sign_offs.empty() || signed_off.sign_offs.back().holds());
  const int status = report.ok() && signature_good ? 0 : 1;
  if (as_json) {
    nlohmann::ordered_json damaged = nlohmann::ordered_json::array();
    for (const Error& error : report.damaged) {
      damaged.push_back({{"where", error.where}, {"what", error.what}, {"mend", error.mend}});
    }
    nlohmann::ordered_json sign_offs = nlohmann::ordered_json::array();
    for (const CheckedSignOff& one : signed_off.sign_offs) {
      sign_offs.push_back(sign_off_json(one));
    }
    CommandContext::print({{"path", path},
                           {"ok", report.ok()},
                           {"whole", report.whole},
                           {"damaged", damaged},
                           {"unrecorded", report.unrecorded},
                           {"sign_offs", sign_offs}});
    return status;
  }
  finish_progress();
  for (const Error& error : report.damaged) {
    std::printf("damaged: %s\n", error.line().c_str());
  }
  for (const std::string& file : report.unrecorded) {
    std::printf("no checksum kept: %s\n", file.c_str());
  }
  for (const Error& error : signed_off.damage) {
    std::printf("damaged sign-off: %s\n", error.line().c_str());
  }
  for (const CheckedSignOff& one : signed_off.sign_offs) {
    std::printf("%s\n", sign_off_line(one).c_str());
  }
  std::printf("%zu whole, %zu damaged\n", report.whole.size(), report.damaged.size());
  return status;
}

Result<int> verify(const std::string& path, CommandContext& context) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (!fs::exists(path, ignored)) {
    return fail(ErrorKind::kUsage, "there is nothing here", path, "give a session folder or a .grid file");
  }
  if (fs::is_regular_file(path, ignored)) {
    VerifyReport report;
    if (const Status status = verify_grid_file(path); !status) {
      report.damaged.push_back(status.error());
    } else {
      report.whole.push_back(path);
    }
    return print_report(path, report, {}, context.json);
  }
  if (!SessionStore::is_session(path)) {
    return fail(ErrorKind::kUsage, "this folder is no session", path,
                "give a session folder or a .grid file");
  }
  const Result<SessionStore> store = SessionStore::open(path, SessionStore::Access::kReadOnly);
  if (!store) {
    return std::unexpected(store.error());
  }
  Result<VerifyReport> report = store->verify(context.job);
  if (!report) {
    return std::unexpected(report.error());
  }
  const Result<SignOffLog> signed_off = read_sign_offs(*store, context.job);
  if (!signed_off) {
    return std::unexpected(signed_off.error());
  }
  return print_report(path, *report, *signed_off, context.json);
}

}  // namespace

void add_verify(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand(
      "verify",
      "Integrity of a session or a grid; status 1 when anything is damaged, or its sign-off no longer holds");
  const auto path = std::make_shared<std::string>();
  verb->add_option("path", *path, "a session folder or a .grid file")->required();
  verb->fallthrough();
  verb->callback([&chosen, path] { chosen = [path](CommandContext& c) { return verify(*path, c); }; });
}

}  // namespace dubsar
