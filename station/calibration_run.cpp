// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/calibration_run.h"

#include <cmath>

#include "acquisition/calibration_folder.h"
#include "acquisition/rig_log.h"
#include "core/number_text.h"
#include "core/units.h"
#include "formats/atomic_file.h"
#include "formats/calibration_json.h"
#include "formats/gray_file.h"
#include "formats/make_folder.h"
#include "formats/rig_toml.h"
#include "station/results.h"
#include "station/verification.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

constexpr double kHottestC = 100;

Result<CalibrationSet> set_in(const fs::path& list) {
  const Result<std::string> text = read_whole_file(list);
  return text ? parse_calibration_set(*text, list.string()) : std::unexpected(text.error());
}

Result<CalibrationSet> set_for(const CalibrateRequest& request) {
  std::error_code ignored;
  const fs::path folder(request.folder);
  if (!fs::is_directory(folder, ignored)) {
    return fail(ErrorKind::kUsage, "there is no such folder", request.folder,
                "give a folder with a calibration.toml, or with pictures of the board and --board");
  }
  const fs::path list = folder / "calibration.toml";
  if (!fs::exists(list, ignored)) {
    if (request.board.empty()) {
      return fail(ErrorKind::kUsage, "there is no calibration.toml in it", request.folder,
                  "write one, or say --board for pictures of the board alone");
    }
    return set_of_folder(folder, request.board);
  }
  Result<CalibrationSet> set = set_in(list);
  if (set && !request.board.empty()) {
    set->board = request.board;
  }
  return set;
}

/// A rig whose calibration is gone measures no more, and which pictures it was made of is written nowhere.
Status check_replaceable(const std::string& out, const std::string& serial) {
  std::error_code ignored;
  if (out.empty() || !fs::is_regular_file(out, ignored)) {
    return {};
  }
  const Result<std::string> text = read_whole_file(out);
  const Result<RigCalibration> there = text ? parse_calibration(*text, out) : std::unexpected(text.error());
  if (!there || there->camera_serial.empty() || there->camera_serial == serial) {
    return {};
  }
  return serial.empty()
             ? fail(ErrorKind::kUsage,
                    "it is the calibration of camera " + there->camera_serial +
                        ", and nobody says of which camera the pictures are",
                    out,
                    "say camera_serial in the calibration.toml of the pictures, or write to another file")
             : fail(ErrorKind::kUsage,
                    "it is the calibration of camera " + there->camera_serial + ", the pictures are of " +
                        serial,
                    out, "write to another file, or move this one away when that camera is gone");
}

std::optional<RigFile> rig_of(const std::string& device_uri) {
  const std::optional<fs::path> file = rig_file_of(device_uri);
  if (!file) {
    return std::nullopt;
  }
  const Result<std::string> text = read_whole_file(*file);
  Result<RigFile> rig = text ? parse_rig_file(*text, file->string()) : std::unexpected(text.error());
  return rig ? std::optional(*std::move(rig)) : std::nullopt;
}

}  // namespace

std::string calibration_place_of(const std::string& device_uri) {
  const std::optional<RigFile> rig = rig_of(device_uri);
  return rig && !rig->calibration.empty()
             ? (rig_file_of(device_uri)->parent_path() / rig->calibration).string()
             : std::string();
}

MotionKind stage_kind_of(const std::string& device_uri) {
  if (const auto calibration = calibration_file_of(device_uri)) {
    const auto known = parse_calibration(calibration->json, calibration->path.string());
    if (known && known->has_motion) {
      return known->motion.kind;
    }
  }
  const std::optional<RigFile> rig = rig_of(device_uri);
  return rig && rig->turns ? MotionKind::kTurntable : MotionKind::kLinear;
}

Result<CalibrateOutcome> calibrate_folder(const CalibrateRequest& request, const JobContext& job) {
  if (request.temperature_c && !(std::abs(*request.temperature_c) <= kHottestC)) {
    return fail(ErrorKind::kUsage, number_text(*request.temperature_c) + " °C is no temperature of a room",
                request.folder, "give degrees Celsius, or leave it away");
  }
  Result<CalibrationSet> set = set_for(request);
  if (!set) {
    return std::unexpected(set.error());
  }
  if (!request.serial.empty() && !set->camera_serial.empty() && request.serial != set->camera_serial) {
    return bad_input(request.folder,
                     "its pictures are of camera " + set->camera_serial + ", not of " + request.serial,
                     "leave the serial number away, or take pictures with that camera");
  }
  const std::string serial = request.serial.empty() ? set->camera_serial : request.serial;
  if (const Status may = check_replaceable(request.out, serial); !may) {
    return std::unexpected(may.error());
  }
  if (set->poses.empty()) {
    return bad_input(request.folder, "there is no pose of the board yet", "take pictures of the board");
  }
  Result<CalibrationPictures> pictures = look_at_pictures(request.folder, *set, job);
  if (!pictures) {
    return std::unexpected(pictures.error());
  }
  CalibrationOptions how;
  how.board = pictures->board;
  how.motion = set->motion;
  how.depth_range_mm = set->depth_range_mm;
  how.plate_margin_mm = set->plate_margin_mm;
  Result<CalibrationReport> report = calibrate_rig(pictures->views, how);
  if (!report) {
    Error error = report.error();
    error.where = error.where.empty() ? request.folder : request.folder + ", " + error.where;
    if (!pictures->left_out.empty()) {
      error.what += " (" + std::to_string(pictures->left_out.size()) +
                    " pictures without a board, the first: " + pictures->left_out.front() + ")";
    }
    return std::unexpected(std::move(error));
  }
  RigCalibration& rig = report->rig;
  rig.made_at = utc_now();
  rig.camera_serial = serial;
  rig.temperature_c = request.temperature_c ? request.temperature_c : set->temperature_c;
  rig.note = set->note;
  if (!request.out.empty()) {
    if (Status status = write_behind_link(request.out, calibration_to_json(rig)); !status) {
      return std::unexpected(status.error());
    }
  }
  return CalibrateOutcome{std::move(*report), std::move(pictures->left_out)};
}

Result<std::string> add_calibration_shot(const fs::path& folder, const CalibrationWords& words,
                                         const CalibrationPicture& picture) {
  const CalibrationShot shot = picture.shot;
  const bool mirror = words.motion == MotionKind::kGalvanometer;
  if (mirror && shot == CalibrationShot::kStop) {
    return fail(ErrorKind::kUsage, "a mirror carries no board", folder.string(),
                "take poses of the board by hand, at three positions of the mirror or more");
  }
  if (const Status made = make_folder(folder); !made) {
    return std::unexpected(made.error());
  }
  const fs::path list = folder / "calibration.toml";
  CalibrationSet set;
  if (std::error_code ignored; fs::exists(list, ignored)) {
    Result<CalibrationSet> known = set_in(list);
    if (!known) {
      return std::unexpected(known.error());
    }
    set = std::move(*known);
  }
  const bool moves = shot == CalibrationShot::kStop || (mirror && shot == CalibrationShot::kBoard);
  if (moves && set.motion && *set.motion != words.motion) {
    return bad_input(list.string(),
                     std::string("its pictures are of a ") + motion_word(*set.motion) +
                         " stage, this is of a " + motion_word(words.motion) + " one",
                     "take the new ones to an empty folder");
  }
  set.motion = moves ? words.motion : set.motion;
  set.board = words.board.empty() ? set.board : words.board;
  set.temperature_c = words.temperature_c ? words.temperature_c : set.temperature_c;
  const bool turns = words.motion != MotionKind::kLinear;
  const double position = turns ? rad_from_deg(picture.position) : picture.position;
  if (!picture.camera_serial.empty()) {
    if (!set.camera_serial.empty() && set.camera_serial != picture.camera_serial) {
      return bad_input(
          list.string(),
          "its pictures are of camera " + set.camera_serial + ", this is camera " + picture.camera_serial,
          "calibrate each camera in a folder of its own");
    }
    set.camera_serial = picture.camera_serial;
  }
  const bool of_pose = shot == CalibrationShot::kLaser || shot == CalibrationShot::kDark;
  if (of_pose && set.poses.empty()) {
    return fail(ErrorKind::kUsage, "there is no pose of the board yet", folder.string(),
                "take a picture of the board first, and leave it where it is");
  }
  const auto free_name = [&](const char* stem, std::size_t from) {
    return numbered_picture(stem, free_picture_number(folder, stem, from), "");
  };
  const auto beside_board = [&](const char* rest) {
    return fs::path(set.poses.back().board).replace_extension().string() + rest;
  };
  std::string name;
  switch (shot) {
    case CalibrationShot::kBoard:
      name = free_name("pose", set.poses.size());
      set.poses.push_back({name, {}, {}, mirror ? position : 0.0});
      break;
    case CalibrationShot::kLaser:
      name = set.poses.back().laser = beside_board("_laser.png");
      break;
    case CalibrationShot::kDark:
      name = set.poses.back().dark = beside_board("_dark.png");
      break;
    case CalibrationShot::kStop:
      name = free_name("stage", set.stops.size());
      set.stops.push_back({name, "board", position});
      break;
  }
  // The picture first: a list must not name what is not there.
  if (Status written = write_gray_png(picture.image, folder / name); !written) {
    return std::unexpected(written.error());
  }
  if (Status written = write_file_atomically(list, calibration_set_to_toml(set)); !written) {
    return std::unexpected(written.error());
  }
  return name;
}

}  // namespace dubsar
