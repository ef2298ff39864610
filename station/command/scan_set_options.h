// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "core/units.h"
#include "station/conf_unit.h"
#include "station/scan_set.h"

namespace dubsar {

/// The options that register, plan and stitch share.
struct ScanSetArguments {
  std::string path;
  std::string unit;
  std::string pins;
  std::string poses;
  std::string out;

  void add_to(CLI::App& verb, bool takes_poses) {
    verb.add_option("path", path, "a session, or a folder or file of range grids")->required();
    verb.add_option("--unit", unit,
                    "what the numbers in the files of a folder are; default: each file's own word, else mm")
        ->check(CLI::IsMember(std::vector<std::string>(kLengthUnits.begin(), kLengthUnits.end())));
    verb.add_option("--pins", pins, "the operator's pins (pins.json)");
    if (takes_poses) {
      verb.add_option("--poses", poses, "take the poses from this file: poses.json, or a Stanford .conf");
    }
    verb.fallthrough();
  }
  [[nodiscard]] ScanSetOptions options() const { return {.unit = unit, .pins_file = pins, .outputs = {out}}; }
  /// --unit says nothing of a session, whose grids are in millimetres; but of a .conf that is named with it.
  [[nodiscard]] Status check_unit(const std::filesystem::path& poses_file) const {
    if (unit.empty() || is_conf(poses_file) || !SessionStore::is_session(path)) {
      return {};
    }
    return fail(ErrorKind::kUsage, "--unit says nothing of a session: its scans are in millimetres", path,
                "if they were scanned in the wrong unit, scan their files into a new session: dubsar scan "
                "--device replay:FOLDER --unit " +
                    unit + " --session NEW");
  }
  /// For who needs to write nothing into a session: it may lie on a share that can only be read.
  [[nodiscard]] ScanSetOptions reading() const {
    ScanSetOptions how = options();
    how.access = ::access(path.c_str(), W_OK) == 0 ? SessionStore::Access::kReadWrite
                                                   : SessionStore::Access::kReadOnly;
    return how;
  }
};

}  // namespace dubsar
