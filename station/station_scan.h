// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "core/pin_set.h"
#include "core/range_grid.h"
#include "core/rig.h"
#include "core/sample_flags.h"

namespace dubsar {

/// One scan as the stages behind the store see it: pins and arms taken out, flags final. Shared, never
/// changed.
struct StationScan {
  int id = 0;
  std::string file;                           ///< original name, or "scan ID"
  std::filesystem::path read_from{};          ///< of a plain folder, absolute; else empty
  std::shared_ptr<const RangeGrid> measured;  ///< as it came, pins and all: registration finds the pins in it
  std::shared_ptr<const RangeGrid> grid;      ///< the tablet alone
  std::shared_ptr<const SampleFlags> flags;
  std::optional<Placement> drive;  ///< turntable and tilt that it was taken with, where the rig has them
  double said_tip_mm = 0;          ///< of the pins that it was prepared with; 0: none were known
  /// Of a scan that is worked on while it is being stored: true once it is on disk, false when it will not
  /// be. Invalid for one that came from the disk. Nothing of the scan is told or saved before.
  std::shared_future<bool> stored;
};

/// Takes pins and arms out of the grid (they are not clay: neither registered, nor meshed, nor red) and flags
/// what is left. `flags`, when given, are those of the stream; they stand when nothing had to be taken out.
[[nodiscard]] StationScan prepare_scan(int id, RangeGrid grid, const std::optional<PinSet>& pins,
                                       std::optional<SampleFlags> flags = std::nullopt);

}  // namespace dubsar
