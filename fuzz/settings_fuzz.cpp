// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Device URIs, boards, and the small texts that a session keeps, each through every reader of such texts.
#include "acquisition/board.h"
#include "acquisition/device_uri.h"
#include "acquisition/pose_json.h"
#include "fuzz/fuzz_support.h"
#include "station/drives.h"

using namespace dubsar;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::text_of(data, size);
  if (const auto drives = parse_drives(text, "drives")) {
    fuzz::require(parse_drives(drives_to_json(*drives), "again").has_value());
  }
  if (const auto pose = session::pose_from_json(1, text)) {
    fuzz::require(session::pose_from_json(1, session::json_from_pose(*pose)).has_value());
  }
  (void)parse_board(text);
  if (const auto uri = parse_device_uri(text)) {
    fuzz::require(parse_device_uri(uri->text()).has_value());
  }
  return 0;
}
