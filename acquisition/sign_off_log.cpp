// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/sign_off_log.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include "core/number_text.h"
#include "core/utf8.h"
#include "formats/red_map_json.h"
#include "formats/sha2.h"
#include "formats/sign_off_json.h"

namespace dubsar {

namespace {

constexpr const char* kSigned = "signed";
constexpr const char* kFirstLine = "dubsar sign-off 2\n";
/// Of a manifest that has no warnings, as earlier versions made them.
constexpr std::string_view kFirstLineBefore = "dubsar sign-off 1\n";

std::string pose_line(const ScanPose& pose) {
  std::string line = "pose " + std::to_string(pose.id) + " " + to_string(pose.status);
  if (pose.status != PoseStatus::kFailed) {
    for (const double value : pose.model_from_scanner.row_major()) {
      line += ' ';
      line += number_text(value);
    }
    line += " sigma_mm ";
    line += number_text(pose.sigma_mm);
  }
  return line + "\n";
}

/// What is wrong with a scan that is in the model all the same; nothing where nothing is.
std::string warning_line(const ScanPose& pose) {
  return pose.status != PoseStatus::kRegistered || pose.warning.empty()
             ? std::string()
             : "warning " + std::to_string(pose.id) + " " + one_line(pose.warning) + "\n";
}

/// A manifest as earlier versions would have made it.
std::string without_warnings(const std::string& manifest) {
  std::string out(kFirstLineBefore);
  std::istringstream lines(manifest.substr(std::string_view(kFirstLine).size()));
  for (std::string line; std::getline(lines, line);) {
    out += line.starts_with("warning ") ? std::string() : line + "\n";
  }
  return out;
}

/// The manifest by what each line is about: "scan 3", "pose 3", "red map", "verdict".
std::map<std::string, std::string> by_subject(const std::string& manifest) {
  std::map<std::string, std::string> out;
  std::istringstream lines(manifest);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = std::min(line.find(' '), line.size());
    std::size_t end = line.size();
    if (const std::string kind = line.substr(0, first);
        kind == "scan" || kind == "pose" || kind == "warning") {
      end = std::min(line.find(' ', std::min(first + 1, line.size())), line.size());
    } else if (kind == "red_map" || kind == "verdict") {
      end = first;
    }
    out[line.substr(0, end)] = line;
  }
  return out;
}

std::string spoken(const std::string& subject) {
  if (subject.starts_with("scan ")) {
    return subject;
  }
  if (subject.starts_with("pose ")) {
    return "the place of scan " + subject.substr(5);
  }
  if (subject.starts_with("warning ")) {
    return "the warning of scan " + subject.substr(8);
  }
  return subject == "red_map" ? "the red map" : subject == "verdict" ? "the verdict" : "\"" + subject + "\"";
}

/// What differs between what was signed and what is there, in words.
std::vector<std::string> differences(const std::string& was, const std::string& is) {
  std::vector<std::string> out;
  const std::map<std::string, std::string> before = by_subject(was);
  const std::map<std::string, std::string> now = by_subject(is);
  for (const auto& [subject, line] : before) {
    const auto there = now.find(subject);
    if (there == now.end()) {
      out.push_back(spoken(subject) + " is no longer part of it");
    } else if (there->second != line) {
      out.push_back(spoken(subject) + " has changed");
    }
  }
  for (const auto& [subject, line] : now) {
    if (!before.contains(subject)) {
      out.push_back(spoken(subject) + " has come since");
    }
  }
  return out;
}

Result<std::string> document_of(const SessionStore& store, const char* name, const char* mend) {
  Result<std::optional<std::string>> text = store.load_document(name);
  if (!text) {
    return std::unexpected(text.error());
  }
  if (!*text) {
    return bad_input(store.folder().string(), std::string("the session has no ") + name, mend);
  }
  return std::move(**text);
}

/// The first number after those of all sign-offs that there are, and that there may have been: each lost
/// event may have been one, with a number above those before it.
Result<int> number_after_all(const SessionStore& store, const std::set<std::string>& lost) {
  constexpr std::string_view kEvent = "events row ";
  int lost_events = 0;
  std::int64_t last_lost = 0;
  for (const std::string& row : lost) {
    if (row.starts_with(kEvent)) {
      std::int64_t number = 0;
      std::from_chars(row.data() + kEvent.size(), row.data() + row.size(), number);
      ++lost_events;
      last_lost = std::max(last_lost, number);
    }
  }
  const auto events = store.events();
  if (!events) {
    return std::unexpected(events.error());
  }
  int last = 0;
  int last_before = 0;
  for (const SessionEvent& event : *events) {
    const Result<RecordedSignOff> recorded =
        event.kind == kSigned ? parse_recorded_sign_off(event.json, {}) : std::unexpected(Error{});
    const int number = recorded ? recorded->sign_off.number : 0;
    last = std::max(last, number);
    last_before = event.number < last_lost ? std::max(last_before, number) : last_before;
  }
  return std::max(last, last_before + lost_events) + 1;
}

}  // namespace

Result<std::string> session_manifest(const SessionStore& store, const JobContext& job) {
  const auto scans = store.scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  const auto poses = store.poses();
  if (!poses) {
    return std::unexpected(poses.error());
  }
  std::string out = kFirstLine;
  for (const StoredScan& scan : *scans) {
    if (scan.dropped) {
      continue;
    }
    const Result<std::string> sum = sha256_of_file(store.folder() / scan.file, job);
    if (!sum) {
      return std::unexpected(sum.error());
    }
    out += "scan " + std::to_string(scan.id) + " " + *sum + " " + scan.file + "\n";
    const auto pose = std::ranges::find(*poses, scan.id, &ScanPose::id);
    out += pose == poses->end() ? "pose " + std::to_string(scan.id) + " none\n"
                                : pose_line(*pose) + warning_line(*pose);
  }
  const Result<std::string> text = document_of(store, "red_map", "run dubsar plan on it first");
  if (!text) {
    return std::unexpected(text.error());
  }
  const Result<RedMap> map = parse_red_map(*text, store.folder().string() + " (red map)");
  if (!map) {
    return std::unexpected(map.error());
  }
  out += "red_map " + sha256_hex(*text) + "\n";
  return out + (map->conclusive ? "verdict conclusive\n" : "verdict not conclusive\n");
}

Result<SignOff> sign_session(SessionStore& store, SignOff sign_off, const JobContext& job) {
  if (sign_off.name.find_first_not_of(" \t\r\n") == std::string::npos) {
    return fail(ErrorKind::kUsage, "a sign-off needs a name", "--name", "give yours");
  }
  for (const auto& [option, text] : {std::pair{"--name", &sign_off.name}, std::pair{"--role", &sign_off.role},
                                     std::pair{"--incomplete", &sign_off.incomplete}}) {
    if (!is_one_line(*text)) {
      return fail(ErrorKind::kUsage, "it has control characters, such as a line break", option,
                  "say it in one line");
    }
  }
  const Result<std::string> manifest = session_manifest(store, job);
  if (!manifest) {
    return std::unexpected(manifest.error());
  }
  const bool conclusive = manifest->ends_with("\nverdict conclusive\n");
  if (conclusive != sign_off.conclusive) {
    return fail(ErrorKind::kUsage, "the session's verdict is not the one that is to be signed",
                store.folder().string(), "run dubsar plan on it, read it, and sign again");
  }
  const Result<std::set<std::string>> lost = store.lost_rows();
  const Result<int> free = lost ? number_after_all(store, *lost) : std::unexpected(lost.error());
  if (!free) {
    return std::unexpected(free.error());
  }
  sign_off.number = *free;
  sign_off.digest = sha256_hex(*manifest);
  // The copies first: a sign-off that is there has what was signed beside it.
  const Result<std::vector<std::string>> names = store.document_names();
  if (!names) {
    return std::unexpected(names.error());
  }
  const auto copy_name = [&](const char* name) {
    return "signed " + std::to_string(sign_off.number) + " " + name;
  };
  const auto is_lost = [&](const char* name) { return lost->contains("documents row " + copy_name(name)); };
  while (std::ranges::binary_search(*names, copy_name("red_map")) || is_lost("red_map") ||
         is_lost("checklist")) {
    ++sign_off.number;  // of a sign-off that was not finished, or whose record is lost
  }
  for (const char* name : {"red_map", "checklist"}) {
    const Result<std::optional<std::string>> text = store.load_document(name);
    if (!text) {
      return std::unexpected(text.error());
    }
    if (*text) {
      if (const Status kept = store.save_document(copy_name(name), **text); !kept) {
        return std::unexpected(kept.error());
      }
    }
  }
  if (const Status stored = store.append_event(kSigned, recorded_sign_off_to_json({sign_off, *manifest}));
      !stored) {
    return std::unexpected(stored.error());
  }
  return sign_off;
}

Result<SignOffLog> read_sign_offs(const SessionStore& store, const JobContext& job) {
  const auto events = store.events();
  if (!events) {
    return std::unexpected(events.error());
  }
  SignOffLog log;
  std::optional<Result<std::string>> now;
  for (const SessionEvent& event : *events) {
    if (event.kind != kSigned) {
      continue;
    }
    Result<RecordedSignOff> recorded =
        parse_recorded_sign_off(event.json, "event " + std::to_string(event.number) + " of the session");
    if (!recorded) {
      log.damage.push_back(recorded.error());
      continue;
    }
    if (!now) {
      now = session_manifest(store, job);
      if (!*now && now->error().kind == ErrorKind::kCancelled) {
        return std::unexpected(now->error());
      }
    }
    CheckedSignOff checked{std::move(recorded->sign_off), {}};
    if (sha256_hex(recorded->manifest) != checked.sign_off.digest) {
      checked.changed.push_back("the record of what was signed does not match its own digest");
    }
    if (!*now) {
      checked.changed.push_back(now->error().line());
    } else {
      const bool is_of_before = recorded->manifest.starts_with(kFirstLineBefore);
      const std::string is = is_of_before ? without_warnings(**now) : **now;
      const std::vector<std::string> more = differences(recorded->manifest, is);
      checked.changed.insert(checked.changed.end(), more.begin(), more.end());
      if (more.empty() && recorded->manifest != is) {
        checked.changed.push_back("the record lists things twice, or in another order");
      }
    }
    log.sign_offs.push_back(std::move(checked));
  }
  return log;
}

}  // namespace dubsar
