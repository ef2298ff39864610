// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar session list | undo | drop | restore: what the operator does to a scan (hint, lock and unlock:
// session_hint.cpp; mesh: session_mesh.cpp).

#include <algorithm>
#include <cstdio>
#include <memory>

#include "acquisition/operator_log.h"
#include "acquisition/session_store.h"
#include "acquisition/sign_off_log.h"
#include "core/log.h"
#include "core/utf8.h"
#include "formats/sign_off_json.h"
#include "station/command/option_checks.h"
#include "station/command/session_verbs.h"
#include "station/session_pages.h"
#include "station/sign_off_words.h"
#include "station/tablet_record.h"
#include "station/told_session.h"

namespace dubsar {

namespace {

struct SessionOptions {
  std::string path;
  int id = -1;
  std::string why;
};

Result<int> list(const SessionOptions& options, CommandContext& context) {
  const Result<SessionStore> store = open_told(options.path, SessionStore::Access::kReadOnly);
  if (!store) {
    return std::unexpected(store.error());
  }
  const auto scans = store->scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  const auto poses = store->poses();
  if (!poses) {
    return std::unexpected(poses.error());
  }
  const Result<OperatorLog> log = read_operator_log(*store);
  if (!log) {
    return std::unexpected(log.error());
  }
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const StoredScan& scan : *scans) {
    std::string status = scan.damaged ? "damaged" : scan.dropped ? "dropped" : "stored";
    std::string reason, warning;
    for (const ScanPose& pose : *poses) {
      if (pose.id == scan.id && !scan.dropped && !scan.damaged) {
        status = to_string(pose.status);
        reason = pose.reason;
        warning = pose.warning;
      }
    }
    rows.push_back({{"id", scan.id},
                    {"grid", scan.file},
                    {"file", scan.source},
                    {"device", scan.device},
                    {"samples", scan.samples},
                    {"status", status},
                    {"reason", reason},
                    {"warning", warning},
                    {"remark", scan.remark},
                    {"locked", log->word.locked.contains(scan.id)},
                    {"hint_on", nullptr},
                    {"note", scan.note}});
    if (const auto hint = log->word.hints.find(scan.id); hint != log->word.hints.end()) {
      rows.back()["hint_on"] = hint->second.on;
    }
  }
  const Result<SignOffLog> signed_off = read_sign_offs(*store, context.job);
  if (!signed_off) {
    return std::unexpected(signed_off.error());
  }
  for (const Error& damage : signed_off->damage) {
    log_warning(damage.line());
  }
  if (context.json) {
    nlohmann::ordered_json sign_offs = nlohmann::ordered_json::array();
    for (const CheckedSignOff& one : signed_off->sign_offs) {
      sign_offs.push_back(sign_off_json(one));
    }
    CommandContext::print({{"session", options.path}, {"scans", rows}, {"sign_offs", sign_offs}});
    return 0;
  }
  for (const auto& row : rows) {
    std::string more;
    const auto add = [&more](const std::string& said) {
      more += (more.empty() || said.empty() ? "" : "; ") + said;
    };
    if (!row["hint_on"].is_null()) {
      add("hint on scan " + std::to_string(row["hint_on"].get<int>()));
    }
    if (row["locked"].get<bool>()) {
      add("locked");
    }
    for (const char* key : {"note", "reason", "warning", "remark"}) {
      add(row[key].get<std::string>());
    }
    std::printf("%3d  %-10s %9ld samples  %s%s%s\n", row["id"].get<int>(),
                row["status"].get<std::string>().c_str(), row["samples"].get<long>(),
                one_line(row["file"].get<std::string>()).c_str(), more.empty() ? "" : ": ",
                one_line(more).c_str());
  }
  for (const CheckedSignOff& one : signed_off->sign_offs) {
    std::printf("%s\n", sign_off_line(one).c_str());
  }
  return 0;
}

/// What came of it for the scan.
struct Change {
  int id = -1;
  std::string is;  ///< what the scan is now
  bool made = true;
};

/// Undo, drop and restore mark scans; poses, verdict with pages, and mesh follow with the next
/// register, plan and stitch. Until then the pages say that they are behind.
template <class Apply>
Result<int> change(const SessionOptions& options, CommandContext& context, const Apply& apply) {
  Result<SessionStore> store = open_for_a_word(options.path);
  if (!store) {
    return std::unexpected(store.error());
  }
  const Result<Change> change = apply(*store);
  if (!change) {
    return std::unexpected(change.error());
  }
  if (context.json) {
    CommandContext::print({{"session", options.path}, {"scan", change->id}, {"changed", change->made}});
  } else {
    std::printf(
        "scan %d %s%s\n", change->id, change->is.c_str(),
        change->made ? "; run register, plan and stitch on the session to follow" : "; nothing changed");
  }
  return 0;
}

/// As the session has it now.
Result<StoredScan> stored_scan(const SessionStore& store, int id) {
  Result<std::vector<StoredScan>> scans = store.scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  const auto scan = std::ranges::find(*scans, id, &StoredScan::id);
  if (scan == scans->end()) {
    return fail(ErrorKind::kUsage, "there is no scan " + std::to_string(id), store.folder().string(),
                "dubsar session list shows the scans");
  }
  return std::move(*scan);
}

/// The first reason stands: it is what the pages and the record say.
Result<Change> drop(SessionStore& store, int id, const std::string& why) {
  const Result<StoredScan> before = stored_scan(store, id);
  if (!before) {
    return std::unexpected(before.error());
  }
  if (before->dropped) {
    const std::string reason = before->note.empty() ? "" : ": " + one_line(before->note);
    if (!why.empty() && why != before->note) {
      return fail(ErrorKind::kUsage, "scan " + std::to_string(id) + " was taken out before" + reason,
                  store.folder().string(), "to give another reason, restore it first");
    }
    return Change{id, "was taken out before" + reason, false};
  }
  const Status taken =
      take_pages_back(store, "scan " + std::to_string(id) + " was taken out", kFollowAndPlan);
  const Status done = taken ? store.drop_scan(id, why) : taken;
  return done ? Result<Change>(Change{id, "is taken out"}) : std::unexpected(done.error());
}

Result<Change> restore(SessionStore& store, int id) {
  const Result<StoredScan> before = stored_scan(store, id);
  if (!before) {
    return std::unexpected(before.error());
  }
  if (!before->dropped) {
    return Change{id, "was not taken out", false};
  }
  const Status taken = take_pages_back(store, "scan " + std::to_string(id) + " was put back", kFollowAndPlan);
  const Status done = taken ? store.restore_scan(id) : taken;
  return done ? Result<Change>(Change{id, "is back in its place"}) : std::unexpected(done.error());
}

/// A field of the tablet's record, and what was said of it on the command line.
struct DescribedField {
  const char* option;
  const char* help;
  std::string TabletRecord::*field;
  std::string given{};
};

/// Says what tablet it is; what is not given stays as it was, and an empty text takes it away.
Result<int> describe(const std::string& path, const std::vector<DescribedField>& given,
                     CommandContext& context) {
  Result<SessionStore> store = open_for_a_word(path);
  if (!store) {
    return std::unexpected(store.error());
  }
  TabletRecord record = tablet_record_of(*store);
  for (const DescribedField& one : given) {
    record.*one.field = one.given;
  }
  if (const Status kept = keep_tablet_record(*store, record); !kept) {
    return std::unexpected(kept.error());
  }
  record = tablet_record_of(*store);
  if (const Status followed = pages_follow_record(*store, context.job); !followed) {
    return std::unexpected(followed.error());
  }
  if (context.json) {
    CommandContext::print(
        {{"session", path}, {"tablet", nlohmann::ordered_json::parse(tablet_record_to_json(record))}});
  } else {
    std::printf("%s\n", one_line(record.museum_number + " " + record.cdli + " " + record.collection).c_str());
  }
  return 0;
}

void add_describe(CLI::App& session, Action& chosen) {
  CLI::App* verb = session.add_subcommand("describe", "Say what tablet it is; an empty text takes it away");
  const auto path = std::make_shared<std::string>();
  const auto fields = std::make_shared<std::vector<DescribedField>>(std::vector<DescribedField>{
      {"--museum-number", "heads the report", &TabletRecord::museum_number},
      {"--cdli", "P and six digits", &TabletRecord::cdli},
      {"--collection", "that it belongs to", &TabletRecord::collection},
      {"--operator", "who scanned it", &TabletRecord::operator_name},
      {"--rights", "whose scans and pictures are, and their licence", &TabletRecord::rights},
      {"--notes", "anything else", &TabletRecord::notes}});
  verb->add_option("session", *path, "a session folder")->required();
  for (DescribedField& one : *fields) {
    CLI::Option* option = verb->add_option(one.option, one.given, one.help);
    option->type_name(kMayBeEmpty);
    if (one.field != &TabletRecord::notes) {
      option->check(single_line());
    }
  }
  verb->fallthrough();
  verb->callback([&chosen, path, fields, verb] {
    std::erase_if(*fields, [verb](const DescribedField& one) { return verb->count(one.option) == 0; });
    chosen = [path, fields](CommandContext& c) { return describe(*path, *fields, c); };
  });
}

Result<Change> undo(SessionStore& store) {
  const auto scans = store.scans();
  const bool any =
      !scans || std::ranges::any_of(*scans, [](const StoredScan& scan) { return !scan.dropped; });
  const Status taken =
      any ? take_pages_back(store, "the newest scan was taken out", kFollowAndPlan) : Status();
  if (!taken) {
    return std::unexpected(taken.error());
  }
  const auto dropped = store.undo_last_scan();
  if (!dropped) {
    return std::unexpected(dropped.error());
  }
  if (!*dropped) {
    return fail(ErrorKind::kUsage, "there is no scan to undo", store.folder().string());
  }
  return Change{**dropped, "is taken out"};
}

}  // namespace

void add_session(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand("session", "What the operator does to a scan");
  verb->require_subcommand(1);
  verb->fallthrough();
  const auto options = std::make_shared<SessionOptions>();
  const auto add = [&](const char* name, const char* help, bool needs_id, auto action) {
    CLI::App* sub = verb->add_subcommand(name, help);
    sub->add_option("session", options->path, "a session folder")->required();
    if (needs_id) {
      sub->add_option("scan", options->id, "the scan's number")->required();
    }
    sub->fallthrough();
    sub->callback([&chosen, options, action] {
      chosen = [options, action](CommandContext& context) { return action(*options, context); };
    });
    return sub;
  };
  add("list", "The scans and their states", false, list);
  add("undo", "Take the newest scan out", false, [](const SessionOptions& o, CommandContext& c) {
    return change(o, c, [](SessionStore& store) { return undo(store); });
  });
  add("drop", "Take a scan out; nothing is deleted", true,
      [](const SessionOptions& o, CommandContext& c) {
        return change(o, c,
                      [&o](SessionStore& store) { return drop(store, o.id, std::string(trimmed(o.why))); });
      })
      ->add_option("--why", options->why, "the reason")
      ->check(single_line())
      ->check(readable());
  add_describe(*verb, chosen);
  add_session_hints(*verb, chosen);
  add_session_mesh(*verb, chosen);
  add_session_sign(*verb, chosen);
  add("restore", "Put a dropped scan back", true, [](const SessionOptions& o, CommandContext& c) {
    return change(o, c, [&o](SessionStore& store) { return restore(store, o.id); });
  });
}

}  // namespace dubsar
