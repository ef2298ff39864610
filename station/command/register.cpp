// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar register: all poses of a session or a folder, from nothing.

#include <cstdio>
#include <memory>

#include "formats/atomic_file.h"
#include "formats/poses_json.h"
#include "station/command/command.h"
#include "station/command/scan_set_options.h"
#include "station/offline.h"

namespace dubsar {

namespace {

Result<int> register_all(const ScanSetArguments& arguments, CommandContext& context) {
  Result<ScanSet> set = load_scan_set(arguments.path, arguments.options(), context.job);
  if (!set) {
    return std::unexpected(set.error());
  }
  const Result<std::vector<ScanPose>> poses = register_scans(*set, context.job);
  if (!poses) {
    return std::unexpected(poses.error());
  }
  if (set->is_session()) {
    if (const Status saved = set->store->save_poses(*poses); !saved) {
      return std::unexpected(saved.error());
    }
  }
  if (!arguments.out.empty()) {
    if (const Status written = write_poses(arguments.out, *poses); !written) {
      return std::unexpected(written.error());
    }
  }
  finish_progress();
  if (context.json) {
    CommandContext::print(nlohmann::ordered_json::parse(poses_to_json(*poses)));
  } else {
    for (const ScanPose& pose : *poses) {
      std::printf("%3d  %-10s rms %.4f mm  sigma %.4f mm  overlap %3.0f %%  %s%s%s\n", pose.id,
                  to_string(pose.status), pose.rms_mm, pose.sigma_mm, 100 * pose.overlap, pose.file.c_str(),
                  pose.reason.empty() ? "" : ": ", pose.reason.c_str());
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
  const auto arguments = std::make_shared<ScanSetArguments>();
  arguments->add_to(*verb, false);
  verb->add_option("-o,--out", arguments->out, "write poses.json here");
  verb->callback([&chosen, arguments] {
    chosen = [arguments](CommandContext& c) { return register_all(*arguments, c); };
  });
}

}  // namespace dubsar
