// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar register: all poses of a session or a folder, from nothing.

#include <tbb/global_control.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include "core/log.h"
#include "core/scan_copies.h"
#include "core/scan_remark.h"
#include "core/utf8.h"
#include "formats/atomic_file.h"
#include "formats/poses_json.h"
#include "formats/red_map_json.h"
#include "planning/groups_apart.h"
#include "station/command/command.h"
#include "station/command/outputs.h"
#include "station/command/scan_set_options.h"
#include "station/followed_word.h"
#include "station/offline.h"

namespace dubsar {

namespace {

struct RegisterArguments : ScanSetArguments {
  bool no_pins = false;
  int rounds = 0;
  int threads = 0;
  std::vector<int> only;
  std::string from_poses;
};

void warn_of_copies(const ScanSet& set, const std::vector<ScanPose>& poses) {
  const auto name = [&](int id) { return std::ranges::find(poses, id, &ScanPose::id)->file; };
  for (const ScanCopy& copy : copies_among(placed_scans(set, poses))) {
    log_warning(name(copy.id) + " has the very samples of " + name(copy.of_id) +
                ", and counts as the same scan");
  }
}

Result<int> register_all(const RegisterArguments& arguments, CommandContext& context) {
  // The result is the same for any number of threads: this is for machines that have other work.
  std::optional<tbb::global_control> limit;
  if (arguments.threads > 0) {
    limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(arguments.threads));
  }
  if (const Status good = arguments.check_unit(arguments.from_poses); !good) {
    return std::unexpected(good.error());
  }
  Result<ScanSet> set = load_scan_set(arguments.path, arguments.options(), context.job);
  if (!set) {
    return std::unexpected(set.error());
  }
  RegisterOptions options;
  options.use_pins = !arguments.no_pins;
  options.only = arguments.only;
  if (arguments.rounds > 0) {
    options.rounds = arguments.rounds;
  }
  if (!arguments.from_poses.empty()) {
    Result<std::vector<ScanPose>> from = poses_from_file(*set, arguments.from_poses, arguments.unit);
    if (!from) {
      return std::unexpected(from.error());
    }
    options.from_poses = std::move(*from);
  }
  const Result<std::vector<ScanPose>> poses = register_scans(*set, options, context.job);
  if (!poses) {
    return std::unexpected(poses.error());
  }
  if (set->is_session()) {
    if (const Status saved = save_followed_poses(*set->store, *poses, options.only); !saved) {
      return std::unexpected(saved.error());
    }
  }
  if (!arguments.out.empty()) {
    if (const Status written = write_poses(arguments.out, *poses); !written) {
      return std::unexpected(written.error());
    }
  }
  warn_of_copies(*set, *poses);
  finish_progress();
  const std::vector<GroupApart> apart = groups_apart(*poses, placed_scans(*set, *poses));
  if (context.json) {
    auto json = nlohmann::ordered_json::parse(poses_to_json(*poses));
    if (!apart.empty()) {
      json["groups_apart"] = apart_json(apart);
    }
    CommandContext::print(json);
  } else {
    for (const ScanPose& pose : *poses) {
      const std::string& remark = remark_of(pose);
      std::printf("%3d  %-10s rms %.4f mm  sigma %.4f mm  overlap %3.0f %%  %s%s%s\n", pose.id,
                  to_string(pose.status), pose.rms_mm, pose.sigma_mm, 100 * pose.overlap,
                  one_line(pose.file).c_str(), remark.empty() ? "" : ": ", remark.c_str());
    }
    for (const GroupApart& group : apart) {
      std::printf("apart: %s\n", group.say.c_str());
    }
  }
  for (const ScanPose& pose : *poses) {
    if (pose.status != PoseStatus::kRegistered) {
      return 1;
    }
  }
  return set->left_out.empty() ? 0 : 1;
}

}  // namespace

void add_register(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand(
      "register", "The poses of all scans; status 1 when one is not registered or cannot be read");
  const auto arguments = std::make_shared<RegisterArguments>();
  arguments->add_to(*verb, false);
  verb->add_option("-o,--out", arguments->out, "write poses.json here");
  verb->add_flag("--no-pins", arguments->no_pins, "use no pins: from the surfaces alone")->excludes("--pins");
  verb->add_option("--only", arguments->only,
                   "register these scans anew (0,3,5) and leave the others as they are")
      ->delimiter(',');
  verb->add_option(
      "--from-poses", arguments->from_poses,
      "start from the poses of this file (poses.json or a Stanford .conf): refine and verify them, look for "
      "no others");
  verb->add_option("--rounds", arguments->rounds, "of pairwise fits and relaxation at the end; default: 2")
      ->check(CLI::Range(1, 50));
  verb->add_option("--threads", arguments->threads,
                   "at most; the result does not depend on it; default: all cores")
      ->check(CLI::Range(1, 1024));
  verb->callback([&chosen, arguments] {
    chosen = with_safe_outputs({arguments->out},
                               [arguments](CommandContext& c) { return register_all(*arguments, c); },
                               {arguments->from_poses, arguments->pins});
  });
}

}  // namespace dubsar
