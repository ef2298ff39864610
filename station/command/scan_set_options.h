// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "core/units.h"
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
                    "what the numbers in the files are; default: each file's own word, else mm")
        ->check(CLI::IsMember(std::vector<std::string>(kLengthUnits.begin(), kLengthUnits.end())));
    verb.add_option("--pins", pins, "the operator's pins (pins.json)");
    if (takes_poses) {
      verb.add_option("--poses", poses, "take the poses from this file: poses.json, or a Stanford .conf");
    }
    verb.fallthrough();
  }
  [[nodiscard]] ScanSetOptions options() const { return {.unit = unit, .pins_file = pins, .output = out}; }
  /// For who needs to write nothing into a session: it may lie on a share that can only be read.
  [[nodiscard]] ScanSetOptions reading() const {
    ScanSetOptions how = options();
    how.access = ::access(path.c_str(), W_OK) == 0 ? SessionStore::Access::kReadWrite
                                                   : SessionStore::Access::kReadOnly;
    return how;
  }
};

}  // namespace dubsar
