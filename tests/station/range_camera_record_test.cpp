// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a session and its checklist know of a rig that is a range camera on a stage.
#include "station/range_camera_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/rig_log.h"
#include "core/mesh.h"
#include "formats/atomic_file.h"
#include "station/results.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;

class RangeCameraRecord : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(write_file_atomically(
        rig_,
        "name = \"r\"\ncamera = \"eye:R1\"\nstage = \"none:\"\n[motion]\nkind = \"linear\"\n"
        "direction = [0, 1, 0]\n[scan]\nfrom_mm = -20\nto_mm = 20\nstep_mm = 0.025\nspeed_mm_s = 5\n"));
    Result<SessionStore> store = SessionStore::open_or_create(folder_.path() / "session");
    ASSERT_TRUE(store) << store.error().line();
    store_.emplace(std::move(*store));
  }
  void verify(const std::string& artefact, bool passed) const {
    const Result<RigLog> log = rig_log_of(rig_);
    ASSERT_TRUE(log) << log.error().line();
    VerificationEntry entry;
    entry.when = "2026-03-04T05:06:07Z";
    entry.artefact = artefact;
    entry.calibration = log->as_it_stands;
    entry.error_mm = 0.012;
    entry.passed = passed;
    ASSERT_TRUE(append_verification(log->log, entry));
  }
  /// As every page of the session has it.
  [[nodiscard]] Checklist checklist(const Rig* rig = nullptr) {
    JobContext job;
    const PlanningStage stage;
    return checklist_of({}, {}, stage, {}, rig, &*store_, job).value();
  }

  test::TemporaryFolder folder_;
  std::filesystem::path rig_ = folder_.path() / "rig.toml";
  std::string device_ = "rig:" + rig_.string();
  std::optional<SessionStore> store_;
};

TEST_F(RangeCameraRecord, TellsTheCameraAndItsLastVerification) {
  verify("bar", true);
  ASSERT_TRUE(keep_range_camera(*store_, device_));
  const Checklist list = checklist();
  EXPECT_THAT(list.calibration, HasSubstr("by the maker of the range camera: eye:R1, linear"));
  ASSERT_TRUE(list.calibration_check);
  EXPECT_EQ(list.calibration_check->when, "2026-03-04T05:06:07Z");
  EXPECT_EQ(list.calibration_check->artefact, "bar");
  EXPECT_EQ(list.calibration_check->error_mm, 0.012);
  Rig other;
  other.calibration = "its own";
  EXPECT_EQ(checklist(&other).calibration, "its own") << "a rig that tells is asked";
}

TEST_F(RangeCameraRecord, OneThatFailedIsNoVerification) {
  verify("bar", true);
  ASSERT_TRUE(keep_range_camera(*store_, device_));
  verify("bar", false);
  ASSERT_TRUE(keep_range_camera(*store_, device_));
  EXPECT_FALSE(checklist().calibration_check);
  EXPECT_THAT(checklist().calibration, HasSubstr("eye:R1"));
}

TEST_F(RangeCameraRecord, OfAnotherDeviceThereIsNone) {
  ASSERT_TRUE(keep_range_camera(*store_, "sim:?seed=1"));
  ASSERT_TRUE(keep_range_camera(*store_, "rig:" + (folder_.path() / "none.toml").string()));
  EXPECT_EQ(checklist().calibration, "");
}

TEST_F(RangeCameraRecord, OneThatCannotBeReadTellsNothing) {
  for (const char* text : {"{", "{}", R"({"calibration": "c", "calibration_check": {"when": 3}})"}) {
    ASSERT_TRUE(store_->save_document("range_camera", text));
    EXPECT_EQ(checklist().calibration, "") << text;
    EXPECT_FALSE(checklist().calibration_check) << text;
  }
}

}  // namespace
}  // namespace dubsar
