// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/verification.h"

#include <ctime>
#include <string_view>

#include "acquisition/range_source.h"
#include "acquisition/rig_log.h"
#include "acquisition/rig_scan.h"
#include "core/log.h"
#include "drivers/loader.h"
#include "formats/atomic_file.h"
#include "station/results.h"

namespace dubsar {

namespace {

struct ArtefactScan {
  RangeGrid grid;
  bool recorded = false;  ///< scanned some time before
};

Result<ArtefactScan> scan_of(const std::string& uri, JobContext& job) {
  const DriverRegistry registry;
  Result<RangeSource> source = RangeSource::open(uri, registry);
  if (!source) {
    return std::unexpected(source.error());
  }
  Result<std::optional<RangeGrid>> grid = source->next({}, job);
  if (!grid) {
    return std::unexpected(grid.error());
  }
  if (!*grid) {
    return fail(ErrorKind::kBadInput, "there is no scan in it", uri, "scan the artefact first");
  }
  for (const std::string& remark : source->record().remarks) {
    log_warning((*grid)->source + ": " + remark);
  }
  const bool recorded = source->capabilities().finite;
  if (recorded) {  // a verdict by the first one would be taken for one by all of them
    const Result<std::optional<RangeGrid>> another = source->next({}, job);
    if (!another && another.error().kind == ErrorKind::kCancelled) {
      return std::unexpected(another.error());
    }
    if (!another || *another) {
      return fail(ErrorKind::kUsage, "there is more than one scan in it", uri,
                  "name the file of one, and verify each by itself");
    }
  }
  return ArtefactScan{std::move(**grid), recorded};
}

/// When it was scanned, where it says a time that can be.
std::optional<std::time_t> time_of(const RangeGrid& grid) {
  constexpr std::time_t kYear2000 = 946684800;
  const std::time_t time = static_cast<std::time_t>(grid.timestamp_ns / 1'000'000'000);
  return time >= kYear2000 && time <= std::time(nullptr) ? std::optional(time) : std::nullopt;
}

/// The serial number of the camera that scanned it, where the scan says one: a rig says "NAME, camera
/// SERIAL", or its name alone.
std::string camera_of(const RangeGrid& grid, const RigLog& log) {
  constexpr std::string_view kMark = ", camera ";
  const std::size_t at = grid.device.rfind(kMark);
  if (at != std::string::npos) {
    return grid.device.substr(at + kMark.size());
  }
  // One word alone may be the name of the rig, which a calibration does not know.
  const bool is_camera =
      log.rig_name.empty() ? grid.device == log.camera_serial : grid.device != log.rig_name;
  return is_camera ? grid.device : std::string();
}

/// A scan that says that it is of another camera, or older than the calibration, proves nothing of it. A
/// range camera has no calibration of ours.
Status is_of(const RigLog& log, const ArtefactScan& scan, const std::string& uri) {
  if (log.of_range_camera()) {
    return {};
  }
  const std::string camera = camera_of(scan.grid, log);
  if (!log.camera_serial.empty() && !camera.empty() && camera != log.camera_serial) {
    return bad_input(uri,
                     "the scan is of camera " + camera + ", the calibration of camera " + log.camera_serial,
                     "scan the artefact with that camera, or name the calibration of this one");
  }
  const std::optional<std::time_t> when = time_of(scan.grid);
  const bool comparable = days_since(log.as_it_stands).has_value();  // else a clock was wrong
  if (scan.recorded && when && comparable && utc_text(*when) < log.as_it_stands) {
    return bad_input(
        uri, "the scan is of " + utc_text(*when) + ", the calibration was made later, on " + log.as_it_stands,
        "scan the artefact again");
  }
  return {};
}

std::optional<RigLog> log_of_device(const std::string& uri) {
  const std::optional<std::filesystem::path> file = rig_file_of(uri);
  if (!file) {
    return std::nullopt;
  }
  Result<RigLog> log = rig_log_of(*file);
  return log ? std::optional(std::move(*log)) : std::nullopt;
}

}  // namespace

nlohmann::ordered_json verification_figures(const Verification& is) {
  nlohmann::ordered_json balls = nlohmann::ordered_json::array();
  for (const MeasuredBall& ball : is.balls) {
    balls.push_back({{"ball", ball.certified + 1},
                     {"diameter_mm", ball.diameter_mm},
                     {"form_um", 1e3 * ball.form_mm},
                     {"size_um", 1e3 * ball.size_mm},
                     {"samples", ball.samples},
                     {"left_out", ball.left_out.count},
                     {"left_out_um", 1e3 * ball.left_out.farthest_mm},
                     {"parts_seen", ball.parts_seen}});
  }
  nlohmann::ordered_json spacings = nlohmann::ordered_json::array();
  for (const MeasuredSpacing& one : is.spacings) {
    spacings.push_back({{"balls", {one.a + 1, one.b + 1}}, {"error_um", 1e3 * one.error_mm}});
  }
  nlohmann::ordered_json out{{"balls", balls}, {"spacings", spacings}};
  if (is.flatness_mm) {
    out["flatness_um"] = 1e3 * *is.flatness_mm;
    out["plane_samples"] = is.plane_samples;
    out["plane_left_out"] = is.plane_left_out.count;
    out["plane_left_out_um"] = 1e3 * is.plane_left_out.farthest_mm;
    out["plane_mm"] = {is.plane_mm[0], is.plane_mm[1]};
  }
  return out;
}

Result<VerifyOutcome> verify_rig(const VerifyRequest& request, JobContext& job) {
  const Result<std::string> text = read_whole_file(request.artefact);
  if (!text) {
    return std::unexpected(text.error());
  }
  Result<Artefact> artefact = parse_artefact(*text, request.artefact);
  if (!artefact) {
    return std::unexpected(artefact.error());
  }
  VerifyOutcome out;
  out.artefact = std::move(*artefact);
  std::optional<RigLog> log;
  if (!request.calibration.empty()) {
    Result<RigLog> of = rig_log_of(request.calibration);
    if (!of) {
      return std::unexpected(of.error());
    }
    log = std::move(*of);
    out.entry.calibration = log->as_it_stands;
    out.log = log->log.string();
  }
  const Result<ArtefactScan> scan = scan_of(request.scan, job);
  if (!scan) {
    return std::unexpected(scan.error());
  }
  if (log) {
    if (Status said = is_of(*log, *scan, request.scan); !said) {
      return std::unexpected(said.error());
    }
    out.camera_unknown = scan->recorded && !log->camera_serial.empty() && camera_of(scan->grid, *log).empty();
  }
  Result<Verification> is = verify_artefact(scan->grid, out.artefact, job);
  if (!is) {
    return std::unexpected(is.error());
  }
  out.is = std::move(*is);
  const std::optional<std::time_t> when = time_of(scan->grid);
  out.time_unknown = scan->recorded && !when;
  // What is scanned now is of now, whatever a camera's own clock says.
  out.entry.when = scan->recorded && when ? utc_text(*when) : utc_now();
  out.entry.artefact = out.artefact.name;
  out.entry.certificate = out.artefact.certificate;
  out.entry.error_mm = out.is.worst_mm();
  out.entry.passed = out.is.passed();
  out.entry.failed = out.is.failed;
  out.entry.measured = verification_figures(out.is).dump();
  if (!out.log.empty()) {
    if (Status status = append_verification(out.log, out.entry); !status) {
      return std::unexpected(status.error());
    }
  }
  return out;
}

std::optional<CalibrationFile> calibration_file_of(const std::string& device_uri) {
  const std::optional<RigLog> log = log_of_device(device_uri);
  if (!log || log->of_range_camera()) {
    return std::nullopt;
  }
  const Result<std::string> json = read_whole_file(log->verified);
  return json ? std::optional(CalibrationFile{log->verified, *json, log->as_it_stands}) : std::nullopt;
}

std::optional<RigCare> care_of(const std::string& device_uri) {
  const std::optional<RigLog> log = log_of_device(device_uri);
  if (!log) {
    return std::nullopt;
  }
  RigCare care;
  care.verified = log->verified.string();
  care.calibration = log->of_range_camera() ? std::string() : care.verified;
  care.last = log->last();
  care.age_days = care.last ? days_since(care.last->when) : std::nullopt;
  return care;
}

}  // namespace dubsar
