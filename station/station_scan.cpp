// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/station_scan.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "planning/sparse_flags.h"
#include "registration/pin_detection.h"

namespace dubsar {

StationScan prepare_scan(int id, RangeGrid grid, const std::optional<PinSet>& pins,
                         std::optional<SampleFlags> flags) {
  StationScan scan;
  scan.id = id;
  scan.file = grid.source.empty() ? "scan " + std::to_string(id) : grid.source;
  if (grid.spacing_mm <= 0) {
    grid.spacing_mm = estimate_spacing_mm(grid);
  }
  scan.said_tip_mm = pins ? pins->tip_diameter_mm : 0;
  if (pins && grid.pin_tip_diameter_mm <= 0) {
    grid.pin_tip_diameter_mm = pins->tip_diameter_mm;
  }
  std::vector<std::uint8_t> mask;
  if (grid.pin_tip_diameter_mm > 0) {
    mask = pin_mask(grid, grid.pin_tip_diameter_mm);
  }
  const bool has_pins = std::find(mask.begin(), mask.end(), 1) != mask.end();
  if (has_pins) {
    RangeGrid tablet = grid;
    for (std::size_t i = 0; i < mask.size(); ++i) {
      tablet.valid[i] = mask[i] != 0 ? 0 : tablet.valid[i];
    }
    scan.grid = std::make_shared<const RangeGrid>(std::move(tablet));
    scan.measured = std::make_shared<const RangeGrid>(std::move(grid));
  } else {
    scan.grid = scan.measured = std::make_shared<const RangeGrid>(std::move(grid));
  }
  if (!flags || has_pins || flags->size() != scan.grid->size()) {
    flags = flag_sparse(*scan.grid);
  }
  scan.flags = std::make_shared<const SampleFlags>(std::move(*flags));
  return scan;
}

}  // namespace dubsar
