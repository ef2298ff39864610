// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/calibration_record.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

namespace dubsar {

Status keep_calibration(SessionStore& store, const CalibrationFile& calibration) {
  const Result<std::vector<std::string>> names = store.document_names();
  if (!names) {
    return std::unexpected(names.error());
  }
  const std::string first = "calibration " + calibration.made_at;
  std::string name = first;
  for (int number = 2; std::ranges::binary_search(*names, name); ++number) {
    const Result<std::optional<std::string>> kept = store.load_document(name);
    if (kept && *kept == calibration.json) {
      return {};
    }
    name = first + " " + std::to_string(number);
  }
  return store.save_document(name, calibration.json);
}

}  // namespace dubsar
