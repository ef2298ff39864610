// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/verification.h"

#include "acquisition/range_source.h"
#include "acquisition/rig_scan.h"
#include "drivers/loader.h"
#include "formats/atomic_file.h"
#include "formats/calibration_json.h"
#include "formats/rig_toml.h"
#include "station/results.h"

namespace dubsar {

namespace {

Result<RigCalibration> calibration_in(const std::filesystem::path& file) {
  const Result<std::string> bytes = read_whole_file(file);
  return bytes ? parse_calibration(*bytes, file.string()) : std::unexpected(bytes.error());
}

Result<RangeGrid> scan_of(const std::string& uri, JobContext& job) {
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
  return std::move(**grid);
}

}  // namespace

nlohmann::ordered_json verification_figures(const Verification& is) {
  nlohmann::ordered_json balls = nlohmann::ordered_json::array();
  for (const MeasuredBall& ball : is.balls) {
    balls.push_back({{"ball", ball.certified + 1},
                     {"diameter_mm", ball.diameter_mm},
                     {"form_um", 1e3 * ball.form_mm},
                     {"size_um", 1e3 * ball.size_mm},
                     {"samples", ball.samples}});
  }
  nlohmann::ordered_json spacings = nlohmann::ordered_json::array();
  for (const MeasuredSpacing& one : is.spacings) {
    spacings.push_back({{"balls", {one.a + 1, one.b + 1}}, {"error_um", 1e3 * one.error_mm}});
  }
  nlohmann::ordered_json out{{"balls", balls}, {"spacings", spacings}};
  if (is.flatness_mm) {
    out["flatness_um"] = 1e3 * *is.flatness_mm;
    out["plane_samples"] = is.plane_samples;
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
  if (!request.calibration.empty()) {
    const Result<RigCalibration> calibration = calibration_in(request.calibration);
    if (!calibration) {
      return std::unexpected(calibration.error());
    }
    out.entry.calibration = calibration->made_at;
  }
  const Result<RangeGrid> grid = scan_of(request.scan, job);
  if (!grid) {
    return std::unexpected(grid.error());
  }
  Result<Verification> is = verify_artefact(*grid, out.artefact);
  if (!is) {
    return std::unexpected(is.error());
  }
  out.is = std::move(*is);
  out.entry.when = utc_now();
  out.entry.artefact = out.artefact.name;
  out.entry.certificate = out.artefact.certificate;
  out.entry.error_mm = out.is.worst_mm();
  out.entry.passed = out.is.passed();
  out.entry.failed = out.is.failed;
  out.entry.measured = verification_figures(out.is).dump();
  if (!request.calibration.empty()) {
    out.log = verification_log_of(request.calibration).string();
    if (Status status = append_verification(out.log, out.entry); !status) {
      return std::unexpected(status.error());
    }
  }
  return out;
}

std::optional<CalibrationFile> calibration_file_of(const std::string& device_uri) {
  constexpr std::string_view kScheme = "rig:";
  if (!device_uri.starts_with(kScheme)) {
    return std::nullopt;
  }
  const std::filesystem::path file = device_uri.substr(kScheme.size());
  const Result<std::string> text = read_whole_file(file);
  const Result<RigFile> rig = text ? parse_rig_file(*text, file.string()) : std::unexpected(text.error());
  if (!rig) {
    return std::nullopt;
  }
  const std::filesystem::path beside = file.parent_path() / rig->calibration;
  const Result<std::string> json = read_whole_file(beside);
  const Result<RigCalibration> calibration =
      json ? parse_calibration(*json, beside.string()) : std::unexpected(json.error());
  if (!calibration) {
    return std::nullopt;
  }
  return CalibrationFile{beside, *json, calibration->made_at};
}

std::optional<RigCare> care_of(const std::string& device_uri) {
  const std::optional<CalibrationFile> file = calibration_file_of(device_uri);
  if (!file) {
    return std::nullopt;
  }
  RigCare care;
  care.calibration = file->path.string();
  // A log that cannot be read says nothing of the rig: it is due.
  const Result<VerificationLog> log = read_verification_log(verification_log_of(file->path));
  if (log && !log->entries.empty() && log->entries.back().calibration == file->made_at) {
    care.last = log->entries.back();
    care.age_days = days_since(care.last->when);
  }
  return care;
}

}  // namespace dubsar
