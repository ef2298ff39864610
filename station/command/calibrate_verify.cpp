// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar calibrate --verify: a certified artefact, measured, against its certificate.

#include <cstdio>

#include "station/command/calibrate.h"
#include "station/command/device_wait.h"
#include "station/command/terminal.h"
#include "station/verification.h"

namespace dubsar {

namespace {

std::string left_out(const LeftOut& left) {
  return left.count == 0 ? std::string() : ", " + std::to_string(left.count) + " left out";
}

void print_figures(const Artefact& artefact, const Verification& is) {
  for (const MeasuredBall& ball : is.balls) {
    std::printf("ball %zu: form %.1f µm, size %+.1f µm, diameter %.4f mm, %zu samples%s\n",
                ball.certified + 1, 1e3 * ball.form_mm, 1e3 * ball.size_mm, ball.diameter_mm, ball.samples,
                left_out(ball.left_out).c_str());
  }
  for (const MeasuredSpacing& one : is.spacings) {
    std::printf("balls %zu and %zu: sphere spacing error %+.1f µm\n", one.a + 1, one.b + 1,
                1e3 * one.error_mm);
  }
  if (is.flatness_mm) {
    std::printf("plane: flatness error %.1f µm over %.1f x %.1f mm, %zu samples%s\n", 1e3 * *is.flatness_mm,
                is.plane_mm[0], is.plane_mm[1], is.plane_samples, left_out(is.plane_left_out).c_str());
  }
  for (const std::string& line : is.failed) {
    std::printf("failed: %s\n", line.c_str());
  }
  std::printf("%s: %s\n", artefact.name.c_str(), is.passed() ? "passed" : "FAILED");
}

}  // namespace

void add_verify_options(CLI::App& verb, VerifyOptions& options) {
  CLI::Option* verify =
      verb.add_option("--verify", options.artefact,
                      "artefact.toml: measure this artefact in the scan that SOURCE is (a file or a "
                      "device) and judge it by its limits");
  verb.add_option("--calibration", options.calibration,
                  "the calibration that is verified, or a rig.toml; the outcome goes into the log beside it")
      ->needs(verify);
}

Result<int> verify_rig(const VerifyOptions& options, const std::string& scan, CommandContext& context) {
  outlive_readers();
  const DevicePatience patience = patience_with_device(context);
  const Result<VerifyOutcome> outcome =
      verify_rig(VerifyRequest{options.artefact, scan, options.calibration}, context.job);
  if (!outcome) {
    return std::unexpected(outcome.error());
  }
  const VerificationEntry& entry = outcome->entry;
  if (context.json) {
    nlohmann::ordered_json json{{"when", entry.when},
                                {"artefact", entry.artefact},
                                {"certificate", entry.certificate},
                                {"passed", entry.passed},
                                {"error_mm", entry.error_mm},
                                {"failed", entry.failed},
                                {"measured", verification_figures(outcome->is)},
                                {"time_unknown", outcome->time_unknown},
                                {"camera_unknown", outcome->camera_unknown}};
    if (!outcome->log.empty()) {
      json["log"] = outcome->log;
    }
    CommandContext::print(json);
  } else {
    finish_progress();
    print_figures(outcome->artefact, outcome->is);
    if (outcome->time_unknown) {
      std::printf("the file does not say when it was scanned: it counts as measured now\n");
    }
    if (outcome->camera_unknown) {
      std::printf("the file does not say which camera scanned it\n");
    }
  }
  return outcome->is.passed() ? 0 : 1;
}

}  // namespace dubsar
