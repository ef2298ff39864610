// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "acquisition/session_store.h"

namespace dubsar {

/// The scans that stand and cannot be read as they were stored, by id.
[[nodiscard]] inline std::vector<int> lost_scans(const std::vector<StoredScan>& scans) {
  std::vector<int> out;
  for (const StoredScan& scan : scans) {
    if (scan.damaged && !scan.dropped) {
      out.push_back(scan.id);
    }
  }
  return out;
}

}  // namespace dubsar
