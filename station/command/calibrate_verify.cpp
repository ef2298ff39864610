// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar calibrate --verify: a certified artefact, measured, against its certificate.

#include <cstdio>

#include "acquisition/artefact.h"
#include "acquisition/range_source.h"
#include "drivers/loader.h"
#include "formats/atomic_file.h"
#include "formats/calibration_json.h"
#include "formats/verification_log.h"
#include "station/command/calibrate.h"
#include "station/results.h"

namespace dubsar {

namespace {

nlohmann::ordered_json figures(const Verification& is) {
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

void print_figures(const Artefact& artefact, const Verification& is) {
  for (const MeasuredBall& ball : is.balls) {
    std::printf("ball %zu: form %.1f µm, size %+.1f µm, diameter %.4f mm, %zu samples\n", ball.certified + 1,
                1e3 * ball.form_mm, 1e3 * ball.size_mm, ball.diameter_mm, ball.samples);
  }
  for (const MeasuredSpacing& one : is.spacings) {
    std::printf("balls %zu and %zu: sphere spacing error %+.1f µm\n", one.a + 1, one.b + 1, 1e3 * one.error_mm);
  }
  if (is.flatness_mm) {
    std::printf("plane: flatness error %.1f µm, %zu samples\n", 1e3 * *is.flatness_mm, is.plane_samples);
  }
  for (const std::string& line : is.failed) {
    std::printf("failed: %s\n", line.c_str());
  }
  std::printf("%s: %s\n", artefact.name.c_str(), is.passed() ? "passed" : "FAILED");
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

void add_verify_options(CLI::App& verb, VerifyOptions& options) {
  CLI::Option* verify = verb.add_option("--verify", options.artefact,
                                        "artefact.toml: measure this artefact in the scan that SOURCE is (a file or a "
                                        "device) and judge it by its limits");
  verb.add_option("--calibration", options.calibration,
                  "the calibration that is verified; the outcome goes into the log beside it")
      ->needs(verify);
}

Result<int> verify_rig(const VerifyOptions& options, const std::string& scan, CommandContext& context) {
  const Result<std::string> text = read_whole_file(options.artefact);
  if (!text) {
    return std::unexpected(text.error());
  }
  const Result<Artefact> artefact = parse_artefact(*text, options.artefact);
  if (!artefact) {
    return std::unexpected(artefact.error());
  }
  VerificationEntry entry;
  if (!options.calibration.empty()) {
    const Result<std::string> bytes = read_whole_file(options.calibration);
    const Result<RigCalibration> calibration =
        bytes ? parse_calibration(*bytes, options.calibration) : std::unexpected(bytes.error());
    if (!calibration) {
      return std::unexpected(calibration.error());
    }
    entry.calibration = calibration->made_at;
  }
  const Result<RangeGrid> grid = scan_of(scan, context.job);
  if (!grid) {
    return std::unexpected(grid.error());
  }
  const Result<Verification> is = verify_artefact(*grid, *artefact);
  if (!is) {
    return std::unexpected(is.error());
  }
  entry.when = utc_now();
  entry.artefact = artefact->name;
  entry.certificate = artefact->certificate;
  entry.error_mm = is->worst_mm();
  entry.passed = is->passed();
  entry.failed = is->failed;
  entry.measured = figures(*is).dump();
  std::string log;
  if (!options.calibration.empty()) {
    log = verification_log_of(options.calibration).string();
    if (Status status = append_verification(log, entry); !status) {
      return std::unexpected(status.error());
    }
  }
  if (context.json) {
    nlohmann::ordered_json json{{"when", entry.when},
                                {"artefact", entry.artefact},
                                {"certificate", entry.certificate},
                                {"passed", entry.passed},
                                {"error_mm", entry.error_mm},
                                {"failed", entry.failed},
                                {"measured", figures(*is)}};
    if (!log.empty()) {
      json["log"] = log;
    }
    CommandContext::print(json);
  } else {
    finish_progress();
    print_figures(*artefact, *is);
  }
  return is->passed() ? 0 : 1;
}

}  // namespace dubsar
