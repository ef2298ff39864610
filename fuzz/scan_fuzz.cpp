// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The readers of scans: one target per format that the file's name can call up (FUZZED_FILE_NAME).
#include "formats/grid_reader.h"
#include "fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = dubsar::fuzz::text_of(data, size);
  const auto scans = dubsar::read_scan_bytes(bytes, FUZZED_FILE_NAME);
  if (scans) {
    // What is read is not left out of a folder unseen.
    dubsar::fuzz::require(dubsar::kind_of_head(bytes, true, FUZZED_FILE_NAME) != dubsar::FileKind::kOther);
    for (const dubsar::ScanData& scan : *scans) {
      if (const auto* grid = std::get_if<dubsar::RangeGrid>(&scan)) {
        dubsar::fuzz::check_grid(*grid);
      } else {
        for (const auto& point : std::get<dubsar::PointCloud>(scan).points) {
          dubsar::fuzz::require(point.allFinite());
        }
      }
    }
  }
  return 0;
}
