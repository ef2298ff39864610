// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar session mesh: the mesh that the session keeps, while it is of its scans as they stand.

#include <cstdio>
#include <memory>

#include "core/log.h"
#include "station/command/session_verbs.h"
#include "station/results.h"
#include "station/told_session.h"

namespace dubsar {

namespace {

Result<int> mesh(const std::string& path, CommandContext& context) {
  const Result<SessionStore> store = open_told(path, SessionStore::Access::kReadOnly);
  if (!store) {
    return std::unexpected(store.error());
  }
  const Result<std::vector<ScanPose>> poses = standing_poses(*store);
  if (!poses) {
    return std::unexpected(poses.error());
  }
  const auto file = stored_mesh_file(*store, *poses, context.job);
  if (!file) {
    return std::unexpected(file.error());
  }
  if (context.json) {
    nlohmann::ordered_json json{{"session", path}, {"mesh", nullptr}};
    if (*file) {
      json["mesh"] = (*file)->string();
    }
    CommandContext::print(json);
  } else if (*file) {
    finish_progress();
    std::printf("%s\n", (*file)->c_str());
  } else {
    log_info("the session keeps no mesh of its scans as they stand; see dubsar stitch");
  }
  return *file ? 0 : 1;
}

}  // namespace

void add_session_mesh(CLI::App& session, Action& chosen) {
  CLI::App* verb = session.add_subcommand(
      "mesh", "Where the mesh lies that the session keeps; status 1 when none is of its scans as they stand");
  const auto path = std::make_shared<std::string>();
  verb->add_option("session", *path, "a session folder")->required();
  verb->fallthrough();
  verb->callback([&chosen, path] { chosen = [path](CommandContext& c) { return mesh(*path, c); }; });
}

}  // namespace dubsar
