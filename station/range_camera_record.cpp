// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/range_camera_record.h"

#include "acquisition/rig_device.h"
#include "acquisition/rig_log.h"
#include "formats/calibration_check_json.h"

namespace dubsar {

namespace {

constexpr const char* kDocument = "range_camera";

}  // namespace

Status keep_range_camera(SessionStore& store, const std::string& device_uri) {
  const std::optional<std::filesystem::path> file = rig_file_of(device_uri);
  const Result<RigLog> log = file ? rig_log_of(*file) : Result<RigLog>(RigLog{});
  if (!log || !log->of_range_camera()) {
    return {};
  }
  OrderedJson json{{"calibration", "by the maker of the range camera: " + log->as_it_stands}};
  if (const std::optional<CalibrationCheck> last = last_verification(*file)) {
    json["calibration_check"] = json_of(*last);
  }
  return store.save_document(kDocument, text_of(json));
}

void tell_of_range_camera(const SessionStore& store, Checklist& list) {
  const auto text = store.load_document(kDocument);
  if (!text || !*text) {
    return;
  }
  const Result<JsonDocument> document = JsonDocument::parse(**text, kDocument);
  if (!document) {
    return;
  }
  const JsonNode root = document->root();
  const std::string calibration = root.at("calibration").text();
  std::optional<CalibrationCheck> last;
  if (const auto check = root.find("calibration_check")) {
    last = read_calibration_check(*check);
  }
  if (document->status("")) {
    list.calibration = calibration;
    list.calibration_check = std::move(last);
  }
}

}  // namespace dubsar
