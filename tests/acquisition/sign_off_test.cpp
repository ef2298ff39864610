// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/sign_off_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/red_map_json.h"
#include "formats/sha2.h"
#include "formats/sign_off_json.h"
#include "tests/acquisition/session_support.h"
#include "tests/acquisition/spoil.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A session of three scans in their places, with a red map.
class SignedSession : public ::testing::Test {
 protected:
  void SetUp() override {
    store_.emplace(*SessionStore::open_or_create(folder_.path() / "s"));
    for (int k = 0; k < 3; ++k) {
      ASSERT_TRUE(store_->add_grid(test::small_grid(k)));
      ScanPose pose;
      pose.id = k;
      pose.status = PoseStatus::kRegistered;
      pose.model_from_scanner.translation_mm = {0.1 * k, 1.0 / 3, 0};
      pose.sigma_mm = 0.01;
      poses_.push_back(pose);
    }
    poses_[2].status = PoseStatus::kFailed;
    ASSERT_TRUE(store_->save_poses(poses_));
    save_map(true);
    ASSERT_TRUE(store_->save_document("checklist", "{}"));
  }
  void save_map(bool conclusive) {
    RedMap map;
    map.conclusive = conclusive;
    ASSERT_TRUE(store_->save_document("red_map", red_map_to_json(map)));
  }
  Result<SignOff> sign(const std::string& name, bool conclusive = true) {
    SignOff s;
    s.name = name;
    s.conclusive = conclusive;
    return sign_session(*store_, s, job_);
  }
  std::vector<std::string> changed() {
    const auto log = read_sign_offs(*store_, job_);
    EXPECT_TRUE(log);
    return log && !log->sign_offs.empty() ? log->sign_offs.back().changed
                                          : std::vector<std::string>{"no sign-off"};
  }

  test::TemporaryFolder folder_;
  std::optional<SessionStore> store_;
  std::vector<ScanPose> poses_;
  JobContext job_;
};

TEST_F(SignedSession, TheManifestCanBeReadAndCheckedWithoutThisProgram) {
  const auto manifest = session_manifest(*store_, job_);
  ASSERT_TRUE(manifest) << manifest.error().line();
  const std::string sum = *sha256_of_file(folder_.path() / "s" / "grids" / "001.grid", job_);
  EXPECT_THAT(*manifest, HasSubstr("dubsar sign-off 2\nscan 0 "));
  EXPECT_THAT(*manifest, HasSubstr("\nscan 1 " + sum + " grids/001.grid\n"));
  EXPECT_THAT(*manifest, HasSubstr("\npose 1 registered 1 0 0 0.1 0 1 0 0.3333333333333333 0 0 1 0 0 0 0 1 "
                                   "sigma_mm 0.01\n"));
  EXPECT_THAT(*manifest, HasSubstr("\npose 2 failed\n"));
  EXPECT_TRUE(manifest->ends_with("\nverdict conclusive\n"));
  EXPECT_EQ(*manifest, *session_manifest(*store_, job_));
}

TEST_F(SignedSession, HoldsUntilSomethingChangesAndSaysWhat) {
  const auto made = sign("A. Reader");
  ASSERT_TRUE(made) << made.error().line();
  EXPECT_EQ(made->number, 1);
  EXPECT_EQ(made->digest, sha256_hex(*session_manifest(*store_, job_)));
  EXPECT_THAT(changed(), IsEmpty());

  ASSERT_TRUE(store_->drop_scan(1, "hand in view"));
  EXPECT_THAT(changed(),
              ElementsAre("the place of scan 1 is no longer part of it", "scan 1 is no longer part of it"));
  ASSERT_TRUE(store_->restore_scan(1));
  EXPECT_THAT(changed(), IsEmpty()) << "all is as it was";

  poses_[0].model_from_scanner.translation_mm.x() = 1e-13;
  ASSERT_TRUE(store_->save_poses(poses_));
  EXPECT_THAT(changed(), ElementsAre("the place of scan 0 has changed"));
  poses_[0].model_from_scanner.translation_mm.x() = 0;
  ASSERT_TRUE(store_->save_poses(poses_));

  save_map(false);
  EXPECT_THAT(changed(), ElementsAre("the red map has changed", "the verdict has changed"));
  save_map(true);
  ASSERT_TRUE(store_->add_grid(test::small_grid(9)));
  EXPECT_THAT(changed(), ElementsAre("the place of scan 3 has come since", "scan 3 has come since"));
}

// Whoever signs a model with lengths that are not to be trusted has said so: it cannot be taken away, or
// come, without the signature saying so.
TEST_F(SignedSession, WhatIsWrongWithAScanInTheModelIsSigned) {
  poses_[1].warning = "against the other scans it is 2 % too long along the motion";
  ASSERT_TRUE(store_->save_poses(poses_));
  EXPECT_THAT(*session_manifest(*store_, job_),
              HasSubstr(" sigma_mm 0.01\nwarning 1 against the other scans it is 2 % too long along the "
                        "motion\nscan 2 "));
  ASSERT_TRUE(sign("A. Reader"));
  EXPECT_THAT(changed(), IsEmpty());
  poses_[1].warning = "";
  ASSERT_TRUE(store_->save_poses(poses_));
  EXPECT_THAT(changed(), ElementsAre("the warning of scan 1 is no longer part of it"));
  ASSERT_TRUE(sign("A. Reader"));
  poses_[0].warning = "its calibration is not theirs";
  ASSERT_TRUE(store_->save_poses(poses_));
  EXPECT_THAT(changed(), ElementsAre("the warning of scan 0 has come since"));
}

TEST_F(SignedSession, ASignatureOfAVersionThatSignedNoWarningsHolds) {
  poses_[1].warning = "its calibration is not theirs";
  ASSERT_TRUE(store_->save_poses(poses_));
  std::string manifest = *session_manifest(*store_, job_);
  const std::string line = "warning 1 its calibration is not theirs\n";
  manifest.erase(manifest.find(line), line.size());
  manifest.replace(0, manifest.find('\n'), "dubsar sign-off 1");
  SignOff made;
  made.number = 1;
  made.name = "A. Reader";
  made.when = "2026-01-02T03:04:05Z";
  made.conclusive = true;
  made.program = "Dubsar 0.1.0";
  made.digest = sha256_hex(manifest);
  ASSERT_TRUE(store_->append_event("signed", recorded_sign_off_to_json({made, manifest})));
  EXPECT_THAT(changed(), IsEmpty());
  poses_[0].sigma_mm = 0.02;
  ASSERT_TRUE(store_->save_poses(poses_));
  EXPECT_THAT(changed(), ElementsAre("the place of scan 0 has changed"));
}

TEST_F(SignedSession, ADamagedScanMakesItVoid) {
  ASSERT_TRUE(sign("A. Reader"));
  test::flip_byte(folder_.path() / "s" / "grids" / "001.grid", 100);
  EXPECT_THAT(changed(), ElementsAre("scan 1 has changed"));
  std::filesystem::remove(folder_.path() / "s" / "grids" / "001.grid");
  ASSERT_EQ(changed().size(), 1U);
  EXPECT_THAT(changed()[0], HasSubstr("001.grid"));
}

TEST_F(SignedSession, EverySignatureStaysWithWhatWasSigned) {
  ASSERT_TRUE(sign("first"));
  const std::string first_map = **store_->load_document("red_map");
  save_map(false);
  ASSERT_TRUE(sign("second", false));
  store_.reset();
  store_.emplace(*SessionStore::open(folder_.path() / "s", SessionStore::Access::kReadOnly));
  const auto log = read_sign_offs(*store_, job_);
  ASSERT_TRUE(log);
  ASSERT_EQ(log->sign_offs.size(), 2U);
  EXPECT_EQ(log->sign_offs[0].sign_off.name, "first");
  EXPECT_FALSE(log->sign_offs[0].holds());
  EXPECT_EQ(log->sign_offs[1].sign_off.number, 2);
  EXPECT_TRUE(log->sign_offs[1].holds());
  EXPECT_EQ(**store_->load_document("signed 1 red_map"), first_map);
  EXPECT_TRUE(*store_->load_document("signed 2 checklist"));
}

TEST_F(SignedSession, TheNumberOfALostSignatureIsNotUsedAgain) {
  ASSERT_TRUE(sign("A. Reader"));
  store_.reset();
  test::spoil_both(folder_.path() / "s", "conclusive");  // its event, and the maps
  store_.emplace(*SessionStore::open(folder_.path() / "s"));
  ASSERT_TRUE(read_sign_offs(*store_, job_)->sign_offs.empty());
  EXPECT_THAT(*store_->lost_rows(), ::testing::Contains("documents row signed 1 red_map"));
  save_map(true);
  EXPECT_EQ(sign("B. Reader")->number, 2);
  EXPECT_EQ(sign("C. Reader")->number, 3);
}

TEST_F(SignedSession, RefusesWhatIsNoSignature) {
  EXPECT_EQ(sign(" \t").error().kind, ErrorKind::kUsage);
  EXPECT_THAT(sign("A", false).error().line(), HasSubstr("not the one that is to be signed"));
  EXPECT_TRUE(read_sign_offs(*store_, job_)->sign_offs.empty());
  const auto empty = SessionStore::open_or_create(folder_.path() / "empty");
  ASSERT_TRUE(empty);
  EXPECT_THAT(session_manifest(*empty, job_).error().line(), HasSubstr("no red_map"));
  JobContext stopped;
  stopped.cancel();
  EXPECT_EQ(session_manifest(*store_, stopped).error().kind, ErrorKind::kCancelled);
}

TEST_F(SignedSession, ARecordThatWasTamperedWithIsVoid) {
  ASSERT_TRUE(sign("A"));
  auto event = store_->events()->back();
  event.json.replace(event.json.find("verdict conclusive"), 18, "verdict ConcluSive");
  ASSERT_TRUE(store_->append_event("signed", event.json));
  EXPECT_THAT(changed(), ElementsAre("the record of what was signed does not match its own digest",
                                     "the verdict has changed"));
  ASSERT_TRUE(store_->append_event("signed", "no json"));
  const auto log = read_sign_offs(*store_, job_);
  ASSERT_TRUE(log);
  EXPECT_EQ(log->damage.size(), 1U);
  EXPECT_EQ(log->sign_offs.size(), 2U);
}

}  // namespace
}  // namespace dubsar
