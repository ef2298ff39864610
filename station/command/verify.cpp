// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar verify: is every stored byte what was stored?

#include <cstdio>
#include <filesystem>
#include <memory>

#include "acquisition/session_store.h"
#include "formats/grid_file.h"
#include "station/command/command.h"

namespace dubsar {

namespace {

int print_report(const std::string& path, const VerifyReport& report, bool as_json) {
  if (as_json) {
    nlohmann::ordered_json damaged = nlohmann::ordered_json::array();
    for (const Error& error : report.damaged) {
      damaged.push_back({{"where", error.where}, {"what", error.what}, {"mend", error.mend}});
    }
    CommandContext::print({{"path", path},
                           {"ok", report.ok()},
                           {"whole", report.whole},
                           {"damaged", damaged},
                           {"unrecorded", report.unrecorded}});
    return report.ok() ? 0 : 1;
  }
  finish_progress();
  for (const Error& error : report.damaged) {
    std::printf("damaged: %s\n", error.line().c_str());
  }
  for (const std::string& file : report.unrecorded) {
    std::printf("no checksum kept: %s\n", file.c_str());
  }
  std::printf("%zu whole, %zu damaged\n", report.whole.size(), report.damaged.size());
  return report.ok() ? 0 : 1;
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
    return print_report(path, report, context.json);
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
  return print_report(path, *report, context.json);
}

}  // namespace

void add_verify(CLI::App& app, Action& chosen) {
  CLI::App* verb =
      app.add_subcommand("verify", "Integrity of a session or a grid; status 1 when anything is damaged");
  const auto path = std::make_shared<std::string>();
  verb->add_option("path", *path, "a session folder or a .grid file")->required();
  verb->fallthrough();
  verb->callback([&chosen, path] { chosen = [path](CommandContext& c) { return verify(*path, c); }; });
}

}  // namespace dubsar
