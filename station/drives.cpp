// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/drives.h"

#include "core/units.h"
#include "formats/json_node.h"
#include "formats/json_text.h"

namespace dubsar {

std::string drives_to_json(const std::map<int, Placement>& drives) {
  OrderedJson scans = OrderedJson::array();
  for (const auto& [id, drive] : drives) {
    OrderedJson scan{{"id", id}, {"turntable_rad", drive.turntable_rad}, {"tilt_rad", drive.tilt_rad}};
    if (drive.free_pose) {
      scan["stage_from_scanner"] = drive.free_pose->row_major();
    }
    scans.push_back(std::move(scan));
  }
  return text_of({{"scans", scans}});
}

Result<std::map<int, Placement>> parse_drives(std::string_view text, const std::string& where) {
  const Result<JsonDocument> document = JsonDocument::parse(text, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  std::map<int, Placement> drives;
  for (const JsonNode& scan : document->root().at("scans").items()) {
    Placement drive;
    drive.turntable_rad = scan.at("turntable_rad").number(-1e3, 1e3);
    drive.tilt_rad = scan.at("tilt_rad").number(-kPi, kPi);
    if (const auto pose = scan.find("stage_from_scanner")) {
      drive.free_pose = pose->transform();
    }
    drives[static_cast<int>(scan.at("id").integer(0, 1000000))] = drive;
  }
  if (const Status status = document->status("the next scan of the session writes it anew"); !status) {
    return std::unexpected(status.error());
  }
  return drives;
}

}  // namespace dubsar
