// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Every way to stop a rig, from the key, the call or the signal to the board of the emulated stage: it
// stands, its laser is off, and what was scanned is kept, with what is known of the calibration.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include "acquisition/session_store.h"
#include "formats/calibration_json.h"
#include "formats/rig_json.h"
#include "station/engine.h"
#include "station/verification.h"
#include "tests/sim/scenes.h"
#include "tests/station/support/command.h"
#include "tests/support/gige_scanner.h"
#include "tests/ui/support/display.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

test::PeerProcess* stage = nullptr;
std::string why_not;

class RigStop : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    if (stage == nullptr) {
      GTEST_SKIP() << "no emulated camera and stage: " << why_not;
    }
    ASSERT_EQ(stage->tell("plug"), "ok");
    static const sim::TestScene scene(sim::make_or_fail(sim::small_clean_tablet()));
    test::GigeScannerPlan plan = test::small_gige_scanner(scene.scene);
    plan.rows = kRows;
    plan.start = kStart;
    plan.step = kStep;
    plan.rate_hz = 10;
    scanner_.emplace(plan, *stage);
    ASSERT_EQ(scanner_->refusal(), "");
  }
  [[nodiscard]] std::string device() const { return "rig:" + scanner_->rig_file().string(); }
  [[nodiscard]] std::string session() const { return (folder_.path() / "session").string(); }
  static double at() { return std::atof(stage->tell("at").c_str()); }
  /// Some rows into the scan. False when it never comes there.
  static bool wait_for_some_rows() {
    for (int k = 0; k < 1200; ++k) {
      if (stage->tell("laser") == "1" && at() > kStart + kSomeRows * kStep) {
        return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  }
  /// By what the board itself says.
  static void expect_dark_and_still() {
    EXPECT_EQ(stage->tell("laser"), "0");
    const double now = at();
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    EXPECT_EQ(at(), now);
    EXPECT_LT(now, kStart + 0.8 * kStep * kRows) << "it went on to the end of the scan";
  }
  void expect_half_a_scan() const {
    const auto store = SessionStore::open(session(), SessionStore::Access::kReadOnly);
    ASSERT_TRUE(store) << store.error().line();
    const auto scans = store->scans();
    ASSERT_TRUE(scans);
    ASSERT_THAT(*scans, SizeIs(1));
    EXPECT_GE(scans->front().rows, 5);
    EXPECT_LT(scans->front().rows, kRows);
    expect_the_calibration(*store);
  }
  /// Its age, and at what temperature and with what note it was made.
  static void expect_the_calibration(const SessionStore& store) {
    const std::string made_at = test::GigeScanner::kMadeAt;
    const auto kept = store.load_document("rig");
    ASSERT_TRUE(kept && *kept);
    const Result<Rig> rig = parse_rig(**kept, "rig");
    ASSERT_TRUE(rig) << rig.error().line();
    EXPECT_THAT(rig->calibration, HasSubstr("made " + made_at + " at 18.5 °C"));
    using std::chrono::days;
    const auto today = std::chrono::floor<days>(std::chrono::system_clock::now());
    const auto age = today - std::chrono::sys_days(std::chrono::year(2026) / 1 / 1);  // of kMadeAt
    EXPECT_NEAR(rig->calibration_age_days.value_or(-1), static_cast<double>(age.count()), 1);
    const auto whole = store.load_document("calibration " + made_at);
    ASSERT_TRUE(whole && *whole);
    const Result<RigCalibration> calibration = parse_calibration(**whole, "calibration");
    ASSERT_TRUE(calibration) << calibration.error().line();
    EXPECT_EQ(calibration->temperature_c, test::GigeScanner::kTemperatureC);
    EXPECT_EQ(calibration->note, test::GigeScanner::kNote);
  }

  static constexpr int kRows = 150;     // at 10 a second
  static constexpr int kSomeRows = 30;  // a busy machine is behind the stage
  static constexpr double kStart = -60;
  static constexpr double kStep = 0.05;
  test::TemporaryFolder folder_;
  std::optional<test::GigeScanner> scanner_;
};

TEST_F(RigStop, TheEmergencyStopOfARun) {
  EngineOptions options;
  options.device = device();
  options.session = session();
  Engine engine(options, {});
  JobContext job;
  std::optional<Result<EngineResult>> result;
  {
    const std::jthread runs([&] { result.emplace(engine.run(job)); });
    EXPECT_TRUE(wait_for_some_rows());
    engine.halt();
  }
  expect_dark_and_still();
  ASSERT_TRUE(result->has_value()) << result->error().line();
  ASSERT_TRUE((*result)->device_error);
  EXPECT_THAT((*result)->device_error->line(), HasSubstr("emergency stop was pressed"));
  expect_half_a_scan();
}

TEST_F(RigStop, TheEmergencyStopOfAVerification) {
  const std::string artefact = (folder_.path() / "artefact.toml").string();
  std::ofstream(artefact)
      << "name = \"plane\"\ncertificate = \"c\"\nplane = true\n[limit]\nflatness_um = 60\n";
  JobContext job;
  std::optional<Result<VerifyOutcome>> result;
  {
    const std::jthread runs([&] { result.emplace(verify_rig({artefact, device(), {}}, job)); });
    EXPECT_TRUE(wait_for_some_rows());
    job.halt();
  }
  expect_dark_and_still();
  ASSERT_FALSE(result->has_value());
  EXPECT_THAT(result->error().line(), HasSubstr("emergency stop was pressed"));
}

TEST_P(RigStop, ASignalToTheCommand) {
  test::RunningCommand running({"scan", "--device", device(), "--session", session()});
  ASSERT_TRUE(wait_for_some_rows()) << running.log_until_now();
  running.send(GetParam());
  if (GetParam() != SIGINT) {
    running.send(SIGHUP);  // a login that ends, or a shell whose terminal is closed, sends it besides
  }
  const test::Outcome stopped = running.wait();
  EXPECT_FALSE(stopped.timed_out);
  EXPECT_EQ(stopped.signal, 0);
  EXPECT_EQ(stopped.status, 1) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("the half scan is kept"));
  EXPECT_THAT(stopped.err, HasSubstr("stopped; 1 scan is stored"));
  expect_dark_and_still();
  expect_half_a_scan();
}
INSTANTIATE_TEST_SUITE_P(Each, RigStop, testing::Values(SIGINT, SIGTERM, SIGHUP),
                         [](const auto& one) { return std::string("Signal") + sigabbrev_np(one.param); });

/// The pictures of a calibration are taken by the same stage.
TEST_F(RigStop, ASignalToACalibrationWhoseStageDoesNotObey) {
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  const int before = ::dup(STDIN_FILENO);
  ::dup2(ends[0], STDIN_FILENO);
  test::RunningCommand running({"calibrate", "--rig", scanner_->rig_file().string(), "--board",
                                "charuco:9x6:5:3.7", (folder_.path() / "pictures").string()});
  ::dup2(before, STDIN_FILENO);
  ASSERT_TRUE(running.says("s: the board lies on the stage")) << running.log_until_now();
  const double home = at();
  ASSERT_EQ(::write(ends[1], "s\n", 2), 2);
  while (at() == home) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ASSERT_EQ(stage->tell("mute"), "ok");
  running.send(SIGINT);
  const test::Outcome stopped = running.wait();
  EXPECT_EQ(stopped.status, 3) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("stopped, but laser and motors may still be on: "));
  for (const int end : {ends[0], ends[1], before}) {
    ::close(end);
  }
}

TEST_F(RigStop, TheKeyOfTheWindow) {
  const test::Display display;
  ASSERT_TRUE(display.works()) << "there is no Xvfb here: install xvfb (packages.txt)";
  const std::string script = (folder_.path() / "a.script").string();
  std::ofstream(script) << "wait idle\nkey space\nwait rows.10\nhalt\nwait stopped\nwait idle\n"
                           "quit\n";
  const test::Outcome played =
      test::run_command({"station", "--device", device(), "--session", session(), "--script", script});
  EXPECT_EQ(played.status, 0) << played.err;
  expect_dark_and_still();
  expect_half_a_scan();
}

}  // namespace
}  // namespace dubsar

int main(int count, char** words) {
  std::signal(SIGHUP, SIG_DFL);  // whoever runs the tests may ignore it, and the command would by inheritance
  const bool lists = count > 1 && std::string(words[1]) == "--gtest_list_tests";
  if (!lists) {
    dubsar::stage = dubsar::test::enter_emulated_machine(words, dubsar::why_not);
  }
  testing::InitGoogleTest(&count, words);
  return RUN_ALL_TESTS();
}
