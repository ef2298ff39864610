// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar session hint | lock | unlock: what the operator says of where a scan lies.

#include <cstdio>
#include <memory>

#include "acquisition/operator_log.h"
#include "formats/atomic_file.h"
#include "formats/hint_json.h"
#include "station/command/option_checks.h"
#include "station/command/session_verbs.h"
#include "station/operator_hint.h"
#include "station/session_pages.h"
#include "station/told_session.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

struct HintArguments {
  std::string session;
  int id = -1;
  int on = -1;
  std::vector<std::string> points;
  std::vector<std::string> pose;
  bool withdraw = false;
};

constexpr const char* kFollow = "run register and plan on the session to follow";

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) {
    all += all.empty() ? word : " " + word;
  }
  return all;
}

/// Before it is kept, what was said of the scan.
Status take_pages_back_for(SessionStore& store, int id, const char* said) {
  return take_pages_back(store, "scan " + std::to_string(id) + " " + said, kFollowAndPlan);
}

bool is_file(const std::string& word) {
  std::error_code ignored;
  return fs::is_regular_file(word, ignored);
}

/// A hint file, which may name the other scan itself; --on must not contradict it.
Result<GivenHint> from_file(const std::string& name, int on) {
  const Result<HintFile> file = read_hint(name);
  if (!file) {
    return std::unexpected(file.error());
  }
  GivenHint given{file->hint, file->model_from_scanner};
  if (on >= 0 && given.hint.on >= 0 && given.hint.on != on) {
    return fail(
        ErrorKind::kUsage,
        "it is about scan " + std::to_string(given.hint.on) + ", and --on names " + std::to_string(on), name,
        "name one");
  }
  given.hint.on = on >= 0 ? on : given.hint.on;
  return given;
}

Result<GivenHint> points_given(const HintArguments& arguments) {
  if (arguments.points.size() == 1 && arguments.points.front().find('=') == std::string::npos) {
    Result<GivenHint> given = from_file(arguments.points.front(), arguments.on);
    if (given && given->hint.points.empty()) {
      return bad_input(arguments.points.front(), "there is no point pair in it",
                       "click at least one place in both scans");
    }
    return given;
  }
  GivenHint given;
  given.hint.on = arguments.on;
  for (const std::string& word : arguments.points) {
    const Result<PointPair> pair = parse_point_pair(word);
    if (!pair) {
      return std::unexpected(pair.error());
    }
    given.hint.points.push_back(*pair);
  }
  return given;
}

Result<GivenHint> pose_given(const HintArguments& arguments) {
  const bool in_file = arguments.pose.size() == 1 && is_file(arguments.pose.front());
  std::string text = joined(arguments.pose);
  if (in_file) {
    const Result<std::string> bytes = read_whole_file(arguments.pose.front(), 1 << 20);
    if (!bytes) {
      return std::unexpected(bytes.error());
    }
    text = *bytes;
    if (text.find('{') != std::string::npos) {
      Result<GivenHint> given = from_file(arguments.pose.front(), arguments.on);
      if (given && !given->model_from_scanner && !given->hint.on_from_scanner) {
        return bad_input(arguments.pose.front(), "there is no pose in it",
                         "give on_from_scanner or model_from_scanner");
      }
      return given;
    }
  }
  const Result<RigidTransform> pose =
      parse_pose_numbers(text, in_file ? arguments.pose.front() : std::string("--pose"));
  if (!pose) {
    return std::unexpected(pose.error());
  }
  GivenHint given;
  given.hint.on = arguments.on;
  given.model_from_scanner = *pose;
  return given;
}

int say(CommandContext& context, const HintArguments& arguments, const std::string& what,
        nlohmann::ordered_json more = nlohmann::ordered_json::object()) {
  if (context.json) {
    nlohmann::ordered_json json{{"session", arguments.session}, {"scan", arguments.id}, {"done", what}};
    json.update(more);
    CommandContext::print(json);
  } else {
    std::printf("scan %d: %s; %s\n", arguments.id, what.c_str(), kFollow);
  }
  return 0;
}

Result<int> hint(const HintArguments& arguments, CommandContext& context) {
  if (static_cast<int>(!arguments.points.empty()) + static_cast<int>(!arguments.pose.empty()) +
          static_cast<int>(arguments.withdraw) !=
      1) {
    return fail(ErrorKind::kUsage, "a hint is points, or a pose, or is withdrawn", "session hint",
                "give --points, --pose or --withdraw");
  }
  Result<SessionStore> store = open_for_a_word(arguments.session);
  if (!store) {
    return std::unexpected(store.error());
  }
  if (arguments.withdraw) {
    const Result<OperatorLog> log = read_operator_log(*store);
    if (!log) {
      return std::unexpected(log.error());
    }
    if (!log->word.hints.contains(arguments.id)) {
      return fail(ErrorKind::kUsage, "there is no hint for scan " + std::to_string(arguments.id),
                  arguments.session, "see dubsar session list");
    }
    const Status taken = take_pages_back_for(*store, arguments.id, "has no hint any more");
    if (const Status kept = taken ? record_hint_withdrawn(*store, arguments.id) : taken; !kept) {
      return std::unexpected(kept.error());
    }
    return say(context, arguments, "the hint is withdrawn");
  }
  const Result<GivenHint> given = arguments.pose.empty() ? points_given(arguments) : pose_given(arguments);
  if (!given) {
    return std::unexpected(given.error());
  }
  const Result<PoseHint> settled = settled_hint(*store, arguments.id, *given);
  if (!settled) {
    return std::unexpected(settled.error());
  }
  const Status taken = take_pages_back_for(*store, arguments.id, "has a hint");
  if (const Status kept = taken ? record_hint(*store, arguments.id, *settled) : taken; !kept) {
    return std::unexpected(kept.error());
  }
  return say(context, arguments, "the hint on scan " + std::to_string(settled->on) + " is kept",
             {{"hint", nlohmann::ordered_json::parse(hint_to_json(*settled))}});
}

Result<int> lock(const HintArguments& arguments, CommandContext& context) {
  Result<SessionStore> store = open_for_a_word(arguments.session);
  if (!store) {
    return std::unexpected(store.error());
  }
  const Result<ScanLock> lock = lock_here(*store, arguments.id);
  if (!lock) {
    return std::unexpected(lock.error());
  }
  const Status taken = take_pages_back_for(*store, arguments.id, "is locked");
  if (const Status kept = taken ? record_lock(*store, arguments.id, *lock) : taken; !kept) {
    return std::unexpected(kept.error());
  }
  return say(context, arguments, "it stays where it is");
}

Result<int> unlock(const HintArguments& arguments, CommandContext& context) {
  Result<SessionStore> store = open_for_a_word(arguments.session);
  if (!store) {
    return std::unexpected(store.error());
  }
  const Result<OperatorLog> log = read_operator_log(*store);
  if (!log) {
    return std::unexpected(log.error());
  }
  if (!log->word.locked.contains(arguments.id)) {
    return fail(ErrorKind::kUsage, "scan " + std::to_string(arguments.id) + " is not locked",
                arguments.session, "see dubsar session list");
  }
  const Status taken = take_pages_back_for(*store, arguments.id, "is unlocked");
  if (const Status kept = taken ? record_unlock(*store, arguments.id) : taken; !kept) {
    return std::unexpected(kept.error());
  }
  return say(context, arguments, "it may move again");
}

}  // namespace

void add_session_hints(CLI::App& session, Action& chosen) {
  const auto arguments = std::make_shared<HintArguments>();
  const auto add = [&](const char* name, const char* help, auto action) {
    CLI::App* sub = session.add_subcommand(name, help);
    sub->add_option("session", arguments->session, "a session folder")->required();
    sub->add_option("scan", arguments->id, "the scan's number")->required();
    sub->fallthrough();
    sub->callback([&chosen, arguments, action] {
      chosen = [arguments, action](CommandContext& context) { return action(*arguments, context); };
    });
    return sub;
  };
  CLI::App* sub = add("hint", "Say where a scan lies: points on it and on another, or a rough pose", hint);
  sub->add_option("--on", arguments->on, "the other scan's number")->check(not_negative());
  sub->add_option(
         "--points", arguments->points,
         "x,y,z=x,y,z: a place in the scan and the same place in the other; three or more, or one or "
         "two to tell between poses that fit; or a file")
      ->expected(1, 1000);
  sub->add_option("--pose", arguments->pose,
                  "16 numbers, row by row, or a file: against the scan of --on, else in the model frame")
      ->expected(1, 16);
  sub->add_flag("--withdraw", arguments->withdraw, "take the hint back");
  add("lock", "Fix a registered scan: nothing moves it", lock);
  add("unlock", "Let a locked scan move again", unlock);
}

}  // namespace dubsar
