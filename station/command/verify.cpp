// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar verify: is every stored byte what was stored? and, asked to, the mend.

#include <cstdio>
#include <filesystem>
#include <memory>

#include "acquisition/session_store.h"
#include "acquisition/sign_off_log.h"
#include "formats/atomic_file.h"
#include "formats/bag_check.h"
#include "formats/bag_repair.h"
#include "formats/files_below.h"
#include "formats/grid_file.h"
#include "formats/sign_off_json.h"
#include "station/command/command.h"
#include "station/mending.h"
#include "station/session_pages.h"
#include "station/sign_off_words.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Names = std::vector<std::string>;

struct Arguments {
  std::string path;
  bool repair = false;
  std::string copy;
};

constexpr const char* kWhatToGive = "give a session folder, a bag or a .grid file";

Json errors_json(const std::vector<Error>& errors) {
  Json out = Json::array();
  for (const Error& error : errors) {
    out.push_back({{"where", error.where}, {"what", error.what}, {"mend", error.mend}});
  }
  return out;
}

void print_names(const char* what, const Names& names) {
  for (const std::string& name : names) {
    std::printf("%s: %s\n", what, Error{ErrorKind::kBadInput, name, {}, {}}.line().c_str());
  }
}

void print_damage(const char* what, const std::vector<Error>& errors) {
  for (const Error& error : errors) {
    std::printf("%s: %s\n", what, error.line().c_str());
  }
}

/// A file that says of itself, or by its name, that it is a grid.
bool claims_to_be_grid(const fs::path& path) {
  const Result<std::string> head = read_file_head(path, 64);
  return path.extension() == ".grid" || (head && is_grid_file(*head));
}

int print_grid(const std::string& path, const CommandContext& context) {
  const Status status = verify_grid_file(path);
  const std::vector<Error> damaged = status ? std::vector<Error>() : std::vector{status.error()};
  const Names whole = status ? Names{path} : Names();
  if (context.json) {
    CommandContext::print({{"path", path},
                           {"kind", "grid"},
                           {"ok", damaged.empty()},
                           {"whole", whole},
                           {"damaged", errors_json(damaged)}});
  } else {
    print_damage("damaged", damaged);
    std::printf("%zu whole, %zu damaged\n", whole.size(), damaged.size());
  }
  return damaged.empty() ? 0 : 1;
}

Result<int> verify_bag(const Arguments& arguments, CommandContext& context) {
  if (arguments.repair && arguments.copy.empty()) {
    return fail(ErrorKind::kUsage, "a bag holds nothing to be mended with", arguments.path,
                "name a copy of it with --from, or export the session anew");
  }
  Result<BagReport> report = check_bag(arguments.path, context.job);
  if (!report) {
    return std::unexpected(report.error());
  }
  std::optional<BagRepair> mended;
  if (arguments.repair && !report->ok()) {
    Result<BagRepair> done = repair_bag(arguments.path, *report, arguments.copy, context.job);
    if (!done) {
      return std::unexpected(done.error());
    }
    mended = std::move(*done);
    report = check_bag(arguments.path, context.job);
    if (!report) {
      return std::unexpected(report.error());
    }
  }
  const std::string aside = mended && mended->set_aside ? mended->set_aside->string() : std::string();
  if (context.json) {
    Json out({{"path", arguments.path},
              {"kind", "bag"},
              {"ok", report->ok()},
              {"bagit_version", report->version},
              {"algorithms", report->algorithms},
              {"whole", report->whole},
              {"damaged", errors_json(report->damaged)},
              {"unrecorded", report->unrecorded},
              {"unchecked", report->unchecked}});
    if (mended) {
      out["repair"] = {{"restored", mended->restored}, {"set_aside", aside}};
    }
    CommandContext::print(out);
    return report->ok() ? 0 : 1;
  }
  finish_progress();
  if (mended) {
    print_names("brought back from the copy", mended->restored);
  }
  if (!aside.empty()) {
    print_names("damaged originals, kept", {aside});
  }
  print_damage("damaged", report->damaged);
  print_names("no checksum kept", report->unrecorded);
  print_names("cannot be checked here", report->unchecked);
  if (!report->ok()) {
    print_names("whole", report->whole);
  }
  std::printf("%zu whole, %zu %s: the bag is %s\n", report->whole.size(), report->damaged.size(),
              report->damaged.size() == 1 ? "fault" : "faults",
              !report->ok()                ? "NOT valid"
              : !report->unchecked.empty() ? "complete, and valid by what can be checked here"
              : !report->unrecorded.empty()
                  ? "complete and valid; it keeps no checksum of what is listed above"
                  : "complete and valid");
  return report->ok() ? 0 : 1;
}

/// What there is to say of a session.
struct Found {
  VerifyReport report;
  SignOffLog signed_off;
  std::vector<Error> behind;  ///< pages that are not of what the session holds
};

/// Each page, and why it is behind.
std::vector<Error> pages_behind(const SessionStore& store) {
  const std::string why = why_pages_are_behind(store);
  const std::string mend = why.empty() ? std::string() : mend_of_pages(store);
  std::vector<Error> out;
  for (const char* page : kPages) {
    std::error_code unknown;
    if (!why.empty() && fs::exists(store.folder() / page, unknown)) {
      out.push_back({ErrorKind::kUsage, why, page, mend});
    }
  }
  return out;
}

int print_session(const std::string& path, const Found& found, const std::optional<Mended>& mended,
                  bool as_json) {
  const VerifyReport& report = found.report;
  const SignOffLog& signed_off = found.signed_off;
  // An older sign-off that a later one stands beside is history; the latest one has to hold.
  const bool signature_good =
      signed_off.damage.empty() && (signed_off.sign_offs.empty() || signed_off.sign_offs.back().holds());
  const bool whole = report.ok() && report.lost.empty();
  const int status = whole && signature_good ? 0 : 1;
  if (as_json) {
    Json sign_offs = Json::array();
    for (const CheckedSignOff& one : signed_off.sign_offs) {
      sign_offs.push_back(sign_off_json(one));
    }
    Json out{{"path", path},
             {"kind", "session"},
             {"ok", whole},
             {"whole", report.whole},
             {"damaged", errors_json(report.damaged)},
             {"lost", errors_json(report.lost)},
             {"unrecorded", report.unrecorded},
             {"extra", report.extra},
             {"set_aside", report.set_aside},
             {"behind", errors_json(found.behind)},
             {"sign_offs", sign_offs},
             {"damaged_sign_offs", errors_json(signed_off.damage)}};
    if (mended) {
      out["repair"] = {{"notes", mended->notes},         {"records", mended->records},
                       {"restored", mended->restored},   {"made_anew", mended->made_anew},
                       {"set_aside", mended->set_aside}, {"beyond", errors_json(mended->beyond)}};
    }
    CommandContext::print(out);
    return status;
  }
  finish_progress();
  if (mended) {
    print_names("mended", mended->notes);
    print_names("brought back from the copy", mended->records);
    print_names("brought back from the copy", mended->restored);
    print_names("made anew", mended->made_anew);
    print_damage("cannot be mended", mended->beyond);
  }
  print_damage("damaged", report.damaged);
  print_damage("lost", report.lost);
  print_names("no checksum kept", report.unrecorded);
  print_names("not of this session", report.extra);
  print_names("original, kept", report.set_aside);
  print_damage("behind", found.behind);
  print_damage("damaged sign-off", signed_off.damage);
  for (const CheckedSignOff& one : signed_off.sign_offs) {
    std::printf("%s\n", sign_off_line(one).c_str());
  }
  if (status != 0) {
    print_names("whole", report.whole);
  }
  std::printf("%zu whole, %zu damaged%s\n", report.whole.size(), report.damaged.size(),
              report.lost.empty() ? "" : ", and records are lost");
  return status;
}

Result<int> verify_session(const Arguments& arguments, CommandContext& context) {
  const auto look = [&]() -> Result<Found> {
    const Result<SessionStore> store = SessionStore::open(arguments.path, SessionStore::Access::kReadOnly);
    if (!store) {
      return std::unexpected(store.error());
    }
    Result<VerifyReport> report = store->verify(context.job);
    if (!report) {
      return std::unexpected(report.error());
    }
    Result<SignOffLog> signed_off = read_sign_offs(*store, context.job);
    if (!signed_off) {
      return std::unexpected(signed_off.error());
    }
    return Found{std::move(*report), std::move(*signed_off), pages_behind(*store)};
  };
  auto found = look();
  if (!found) {
    return std::unexpected(found.error());
  }
  std::optional<Mended> mended;
  if (arguments.repair && (!found->report.ok() || !found->report.lost.empty())) {
    const std::optional<fs::path> copy =
        arguments.copy.empty() ? std::nullopt : std::optional<fs::path>(arguments.copy);
    Result<Mended> done = mend_session(arguments.path, found->report, copy, context.job);
    if (!done) {
      return std::unexpected(done.error());
    }
    mended = std::move(*done);
    found = look();
    if (!found) {
      return std::unexpected(found.error());
    }
  }
  return print_session(arguments.path, *found, mended, context.json);
}

Result<int> verify(const Arguments& arguments, CommandContext& context) {
  if (const Status readable = check_folder_can_be_read(arguments.path); !readable) {
    return std::unexpected(readable.error());
  }
  std::error_code error;
  if (!fs::exists(arguments.path, error)) {
    return fail(ErrorKind::kUsage, "there is nothing here", arguments.path, kWhatToGive);
  }
  if (const Status readable = check_folder_can_be_read(arguments.copy); !readable) {
    return std::unexpected(readable.error());
  }
  const bool is_session = SessionStore::is_session(arguments.path);
  const std::string kind = is_session ? "session" : "bag";
  const std::string mend = "name the folder that the " + kind + " was copied to";
  if (!arguments.copy.empty() && is_session && !SessionStore::is_session(arguments.copy)) {
    return fail(ErrorKind::kUsage, "the copy is no session", arguments.copy, mend);
  }
  if (!arguments.copy.empty() && fs::equivalent(arguments.copy, arguments.path, error)) {
    return fail(ErrorKind::kUsage, "the copy is the " + kind + " itself", arguments.copy, mend);
  }
  if (fs::is_regular_file(arguments.path, error) && claims_to_be_grid(arguments.path)) {
    if (arguments.repair) {
      return fail(ErrorKind::kUsage, "a grid by itself holds nothing to be mended with", arguments.path,
                  "copy it again, or mend the session that it is of");
    }
    return print_grid(arguments.path, context);
  }
  if (is_session) {
    return verify_session(arguments, context);
  }
  if (is_bag(arguments.path)) {
    return verify_bag(arguments, context);
  }
  return fail(ErrorKind::kUsage, "this is no session, no bag and no grid", arguments.path, kWhatToGive);
}

}  // namespace

void add_verify(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand("verify",
                                      "Integrity of a session, a bag or a grid; status 1 when anything is "
                                      "damaged or lost, or its sign-off no longer holds");
  const auto arguments = std::make_shared<Arguments>();
  verb->add_option("path", arguments->path, "a session folder, a bag or a .grid file")->required();
  CLI::Option* repair =
      verb->add_flag("--repair", arguments->repair,
                     "mend a session with what it has, or a bag from a copy; damaged originals "
                     "are kept aside, and so is what was whole of a mesh that does not come back");
  verb->add_option("--from", arguments->copy,
                   "a copy of the session, or of the bag, to bring damaged files and lost records back from")
      ->needs(repair);
  verb->fallthrough();
  verb->callback(
      [&chosen, arguments] { chosen = [arguments](CommandContext& c) { return verify(*arguments, c); }; });
}

}  // namespace dubsar
