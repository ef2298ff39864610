// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/calibration_check_json.h"

namespace dubsar {

OrderedJson json_of(const CalibrationCheck& check) {
  return {{"when", check.when}, {"artefact", check.artefact}, {"error_mm", check.error_mm}};
}

CalibrationCheck read_calibration_check(const JsonNode& node) {
  return {node.at("when").text(), node.at("artefact").text(), node.at("error_mm").number(0, 1e6)};
}

}  // namespace dubsar
