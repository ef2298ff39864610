// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar session list | undo | drop | restore: what the operator does to a scan (hint, lock and unlock:
// session_hint.cpp; mesh: session_mesh.cpp).

#include <cstdio>
#include <memory>

#include "acquisition/operator_log.h"
#include "acquisition/session_store.h"
#include "acquisition/sign_off_log.h"
#include "core/log.h"
#include "formats/sign_off_json.h"
#include "station/command/session_verbs.h"
#include "station/command/sign_off_words.h"
#include "station/tablet_record.h"

namespace dubsar {

namespace {

struct SessionOptions {
  std::string path;
  int id = -1;
  std::string why;
};

Result<int> list(const SessionOptions& options, CommandContext& context) {
  const Result<SessionStore> store = SessionStore::open(options.path, SessionStore::Access::kReadOnly);
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
    std::string reason;
    for (const ScanPose& pose : *poses) {
      if (pose.id == scan.id && !scan.dropped && !scan.damaged) {
        status = to_string(pose.status);
        reason = pose.reason;
      }
    }
    rows.push_back({{"id", scan.id},
                    {"grid", scan.file},
                    {"file", scan.source},
                    {"device", scan.device},
                    {"samples", scan.samples},
                    {"status", status},
                    {"reason", reason},
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
    std::string more = row["note"].get<std::string>() + row["reason"].get<std::string>();
    if (row["locked"].get<bool>()) {
      more = "locked" + (more.empty() ? "" : "; " + more);
    }
    if (!row["hint_on"].is_null()) {
      more = "hint on scan " + std::to_string(row["hint_on"].get<int>()) + (more.empty() ? "" : "; " + more);
    }
    std::printf("%3d  %-10s %9ld samples  %s%s%s\n", row["id"].get<int>(),
                row["status"].get<std::string>().c_str(), row["samples"].get<long>(),
                row["file"].get<std::string>().c_str(), more.empty() ? "" : ": ", more.c_str());
  }
  for (const CheckedSignOff& one : signed_off->sign_offs) {
    std::printf("%s\n", sign_off_line(one).c_str());
  }
  return 0;
}

/// Undo, drop and restore mark scans; the poses and the mesh follow with the next register and stitch.
/// `what`: what the scan is then.
template <class Change>
Result<int> change(const SessionOptions& options, CommandContext& context, const char* what,
                   const Change& apply) {
  Result<SessionStore> store = SessionStore::open(options.path);
  if (!store) {
    return std::unexpected(store.error());
  }
  const Result<int> id = apply(*store);
  if (!id) {
    return std::unexpected(id.error());
  }
  if (context.json) {
    CommandContext::print({{"session", options.path}, {"scan", *id}});
  } else {
    std::printf("scan %d is %s; run register and stitch on the session to follow\n", *id, what);
  }
  return 0;
}

/// Says what tablet it is; what is not given stays as it was.
Result<int> describe(const std::string& path, const TabletRecord& given, CommandContext& context) {
  Result<SessionStore> store = SessionStore::open(path);
  if (!store) {
    return std::unexpected(store.error());
  }
  TabletRecord record = tablet_record_of(*store);
  const auto take = [](const std::string& from, std::string& into) { into = from.empty() ? into : from; };
  take(given.museum_number, record.museum_number);
  take(given.cdli, record.cdli);
  take(given.collection, record.collection);
  take(given.operator_name, record.operator_name);
  take(given.notes, record.notes);
  if (const Status kept = keep_tablet_record(*store, record); !kept) {
    return std::unexpected(kept.error());
  }
  if (context.json) {
    CommandContext::print(
        {{"session", path}, {"tablet", nlohmann::ordered_json::parse(tablet_record_to_json(record))}});
  } else {
    std::printf("%s %s %s\n", record.museum_number.c_str(), record.cdli.c_str(), record.collection.c_str());
  }
  return 0;
}

void add_describe(CLI::App& session, Action& chosen) {
  CLI::App* verb = session.add_subcommand("describe", "Say what tablet it is");
  const auto path = std::make_shared<std::string>();
  const auto given = std::make_shared<TabletRecord>();
  verb->add_option("session", *path)->required();
  verb->add_option("--museum-number", given->museum_number, "heads the report");
  verb->add_option("--cdli", given->cdli, "P and six digits");
  verb->add_option("--collection", given->collection, "that it belongs to");
  verb->add_option("--operator", given->operator_name, "who scanned it");
  verb->add_option("--notes", given->notes, "anything else");
  verb->fallthrough();
  verb->callback([&chosen, path, given] {
    chosen = [path, given](CommandContext& c) { return describe(*path, *given, c); };
  });
}

Result<int> undo(SessionStore& store) {
  const auto dropped = store.undo_last_scan();
  if (!dropped) {
    return std::unexpected(dropped.error());
  }
  if (!*dropped) {
    return fail(ErrorKind::kUsage, "there is no scan to undo", store.folder().string());
  }
  return **dropped;
}

}  // namespace

void add_session(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand("session", "What the operator does to a scan");
  verb->require_subcommand(1);
  verb->fallthrough();
  const auto options = std::make_shared<SessionOptions>();
  const auto add = [&](const char* name, const char* help, bool needs_id, auto action) {
    CLI::App* sub = verb->add_subcommand(name, help);
    sub->add_option("session", options->path)->required();
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
    return change(o, c, "taken out", [](SessionStore& store) { return undo(store); });
  });
  add("drop", "Take a scan out; nothing is deleted", true, [](const SessionOptions& o, CommandContext& c) {
    return change(o, c, "taken out", [&o](SessionStore& store) -> Result<int> {
      const Status done = store.drop_scan(o.id, o.why);
      return done ? Result<int>(o.id) : std::unexpected(done.error());
    });
  })->add_option("--why", options->why, "the reason");
  add_describe(*verb, chosen);
  add_session_hints(*verb, chosen);
  add_session_mesh(*verb, chosen);
  add_session_sign(*verb, chosen);
  add("restore", "Put a dropped scan back", true, [](const SessionOptions& o, CommandContext& c) {
    return change(o, c, "back in its place", [&o](SessionStore& store) -> Result<int> {
      const Status done = store.restore_scan(o.id);
      return done ? Result<int>(o.id) : std::unexpected(done.error());
    });
  });
}

}  // namespace dubsar
