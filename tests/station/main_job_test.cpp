// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The main job: a made-up tablet, scanned until it is conclusive, and the same stages again on its session.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <map>

#include "formats/poses_json.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::Outcome;
using test::run_command;

class MainJob : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    first_ = scan("first", {});
  }
  static void TearDownTestSuite() { delete folder_; }

  [[nodiscard]] static fs::path at(const std::string& name) { return folder_->path() / name; }
  static Outcome scan(const std::string& session, const test::CommandOptions& options) {
    return run_command({"scan", "--auto", "--json", "--device",
                        "sim:?seed=2&size=24x20x10&spacing=0.3&truth=" + at("truth of " + session).string(),
                        "--session", at(session).string()},
                       options);
  }
  static void expect_the_same_bytes(const std::string& session) {
    for (const char* file : {"export/poses.json", "export/red_map.json", "mesh/model.ply"}) {
      EXPECT_FALSE(bytes_of(at("first") / file).empty()) << file;
      EXPECT_TRUE(bytes_of(at("first") / file) == bytes_of(at(session) / file)) << file;
    }
  }

  static test::TemporaryFolder* folder_;
  static Outcome first_;
};
test::TemporaryFolder* MainJob::folder_ = nullptr;
Outcome MainJob::first_;

TEST_F(MainJob, EndsConclusiveWithAllThatIsPromised) {
  ASSERT_EQ(first_.status, 0) << first_.err;
  const nlohmann::json json = first_.json();
  ASSERT_TRUE(json.is_object()) << first_.out;
  EXPECT_EQ(json["conclusive"], true);
  EXPECT_LE(json["scans"].get<int>(), 40);
  for (const char* file : {"mesh", "report", "red_map_picture", "six_views", "wedges"}) {
    EXPECT_TRUE(fs::is_regular_file(json[file].get<std::string>())) << file;
  }
  EXPECT_EQ(run_command({"mesh", "check", json["mesh"].get<std::string>()}).status, 0);
  const std::string mesh = bytes_of(json["mesh"].get<std::string>());
  EXPECT_NE(mesh.substr(0, mesh.find("end_header")).find("comment SIMULATED: "), std::string::npos);
}

TEST_F(MainJob, PosesAreTrueToATenthOfAMillimetre) {
  const auto poses = read_poses(at("first") / "export" / "poses.json");
  const auto truth = read_poses(at("truth of first") / "truth_poses.json");
  ASSERT_TRUE(poses.has_value());
  ASSERT_TRUE(truth.has_value());
  std::map<std::string, RigidTransform> true_pose;
  for (const ScanPose& pose : *truth) {
    true_pose[fs::path(pose.file).stem().string()] = pose.model_from_scanner;
  }
  ASSERT_GE(poses->size(), 4U);
  const ScanPose& gauge = poses->front();
  const RigidTransform truth_from_model =
      true_pose.at(fs::path(gauge.file).stem().string()) * gauge.model_from_scanner.inverse();
  for (const ScanPose& pose : *poses) {
    ASSERT_EQ(pose.status, PoseStatus::kRegistered) << pose.reason;
    const RigidTransform mine = truth_from_model * pose.model_from_scanner;
    const RigidTransform& theirs = true_pose.at(fs::path(pose.file).stem().string());
    // How far the pose shifts the corners of the tablet, which lies about the middle of its own frame.
    for (const Eigen::Vector3d& corner :
         {Eigen::Vector3d(12, 10, 5), Eigen::Vector3d(-12, 10, -5), Eigen::Vector3d(12, -10, -5)}) {
      const Eigen::Vector3d seen = theirs.inverse() * corner;
      EXPECT_LT((mine * seen - corner).norm(), 0.1) << pose.file;
    }
  }
}

TEST_F(MainJob, TheStagesAgainSayTheSame) {
  const std::string session = at("first").string();
  const Outcome plan = run_command({"plan", session, "--json"});
  EXPECT_EQ(plan.status, first_.status) << plan.err;
  EXPECT_EQ(plan.json()["conclusive"], first_.json()["conclusive"]);
  EXPECT_EQ(plan.json()["stored"]["same"], true) << "worked out anew from grids and poses: " << plan.out;
  const Outcome verified = run_command({"verify", session, "--json"});
  EXPECT_EQ(verified.status, 0) << verified.out;
  EXPECT_EQ(verified.json()["ok"], true);
  const fs::path wedges = at("first") / "analysis" / "wedges.json";
  EXPECT_TRUE(
      fs::exists(wedges.parent_path() / nlohmann::json::parse(bytes_of(wedges))["mesh"].get<std::string>()));
  const std::string mesh = at("again.ply").string();
  const Outcome stitched = run_command({"stitch", session, "-o", mesh, "--json"});
  EXPECT_EQ(stitched.status, 0) << stitched.err;
  EXPECT_EQ(run_command({"mesh", "check", mesh}).status, 0);
  const Outcome registered = run_command({"register", session, "--json"});
  EXPECT_EQ(registered.status, 0) << registered.err;
  EXPECT_EQ(registered.json()["scans"].size(), first_.json()["scans"].get<std::size_t>());
  EXPECT_EQ(run_command({"verify", session}).status, 0);
}

TEST_F(MainJob, TheVerdictCanBeWorkedOutFromGridsAndPosesAlone) {
  fs::copy(at("first"), at("bare"), fs::copy_options::recursive);
  fs::remove_all(at("bare") / "mesh");
  fs::remove_all(at("bare") / "export");
  const std::string map = at("again.json").string();
  const Outcome plan = run_command({"plan", at("bare").string(), "-o", map, "--json"});
  EXPECT_EQ(plan.status, 0) << plan.err;
  EXPECT_TRUE(bytes_of(map) == bytes_of(at("first") / "export" / "red_map.json"));
  // The mesh is stitched anew, and what the checklist says of the surface is the same to the last digit.
  const Outcome with_mesh = run_command({"plan", at("first").string(), "--json"});
  EXPECT_EQ(plan.json()["checklist"]["faces"], with_mesh.json()["checklist"]["faces"]);
  EXPECT_GT(plan.json()["checklist"]["faces"]["obverse"]["seen_mm2"], 300);
  EXPECT_GT(plan.json()["checklist"]["sampling"]["places"], 50000);
}

TEST_F(MainJob, ASignatureHoldsUntilTheSessionChanges) {
  fs::copy(at("first"), at("signed"), fs::copy_options::recursive);
  const std::string session = at("signed").string();
  const Outcome idle =
      run_command({"session", "sign", session, "--name", "A. Reader", "--incomplete", "the back is missing"});
  EXPECT_EQ(idle.status, 2) << "nothing is incomplete";
  EXPECT_THAT(idle.complaints(), ::testing::SizeIs(1)) << idle.err;
  const Outcome signed_off =
      run_command({"session", "sign", session, "--name", "A. Reader", "--role", "conservator", "--json"});
  ASSERT_EQ(signed_off.status, 0) << signed_off.err;
  const nlohmann::json json = signed_off.json();
  EXPECT_EQ(json["sign_off"]["conclusive"], true);
  EXPECT_EQ(json["sign_off"]["sha256"].get<std::string>().size(), 64U);
  EXPECT_THAT(bytes_of(json["checklist"].get<std::string>()), ::testing::HasSubstr("Signed by A. Reader on"));
  EXPECT_THAT(bytes_of(at("signed") / "export" / "report.html"),
              ::testing::HasSubstr("Signed by A. Reader on"));
  EXPECT_TRUE(bytes_of(at("signed") / "mesh" / "model.ply") == bytes_of(at("first") / "mesh" / "model.ply"));

  const Outcome whole = run_command({"verify", session, "--json"});
  EXPECT_EQ(whole.status, 0) << whole.out;
  EXPECT_EQ(whole.json()["sign_offs"][0]["holds"], true);
  EXPECT_EQ(run_command({"plan", session, "--json"}).json()["checklist"]["sign_off"]["holds"], true);

  ASSERT_EQ(run_command({"session", "drop", session, "1"}).status, 0);
  const Outcome changed = run_command({"verify", session, "--json"});
  EXPECT_EQ(changed.status, 1);
  EXPECT_EQ(changed.json()["ok"], true) << "every byte is there; it is the signature that is void";
  EXPECT_EQ(changed.json()["sign_offs"][0]["holds"], false);
  EXPECT_THAT(run_command({"session", "list", session}).out, ::testing::HasSubstr("VOID"));
  const Outcome stale = run_command({"session", "sign", session, "--name", "B", "--json"});
  EXPECT_EQ(stale.status, 1) << "its red map is that of one scan more";
  EXPECT_THAT(stale.complaints(), ::testing::SizeIs(1)) << stale.err;
  ASSERT_EQ(run_command({"session", "restore", session, "1"}).status, 0);
  EXPECT_EQ(run_command({"verify", session}).status, 0) << "all is as it was signed";
}

/// 100 mm of tablet under a scanner whose field is 70 mm wide: its ends come under it when it is pushed
/// along.
TEST_F(MainJob, ATabletLargerThanTheFieldIsPushedAlongUntilAllOfItIsScanned) {
  const Outcome large =
      run_command({"scan", "--auto", "--json", "--device", "sim:?seed=2&size=100x20x12&spacing=0.5",
                   "--max-scans", "24", "--session", at("large").string()});
  EXPECT_EQ(large.status, 0) << large.err;
  EXPECT_EQ(large.json()["conclusive"], true);
}

TEST_F(MainJob, AConclusiveSessionAsksForNothingMore) {
  fs::copy(at("first"), at("gone on"), fs::copy_options::recursive);
  const Outcome again = scan("gone on", {});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(again.json()["scans"], first_.json()["scans"]);
}

TEST_F(MainJob, AStoppedRunIsGoneOnWithToTheEnd) {
  {
    test::RunningCommand running({"scan", "--auto", "--json", "--device",
                                  "sim:?seed=2&size=24x20x10&spacing=0.3", "--session",
                                  at("stopped").string()});
    ASSERT_TRUE(running.says("scan 2 stored"));
    running.send(SIGTERM);
    const Outcome stopped = running.wait();
    ASSERT_EQ(stopped.status, 1) << stopped.err;
    // In the middle of a scan, its half is kept, and that is told besides.
    const bool half = stopped.err.find("half scan is kept") != std::string::npos;
    EXPECT_THAT(stopped.complaints(), ::testing::SizeIs(half ? 2 : 1)) << stopped.err;
    EXPECT_THAT(stopped.json()["error"]["what"].get<std::string>(), ::testing::HasSubstr("scans are stored"));
  }
  // Without a judged pose for every scan, the stages work the poses out themselves.
  EXPECT_EQ(run_command({"plan", at("stopped").string(), "--json"}).status, 1);
  const Outcome gone_on = scan("stopped", {});
  EXPECT_EQ(gone_on.status, 0) << gone_on.err;
  EXPECT_EQ(run_command({"verify", at("stopped").string()}).status, 0);
}

TEST_F(MainJob, TheSameCommandGivesTheSameBytesOnOneCoreToo) {
  test::CommandOptions options;
  options.one_core = true;
  EXPECT_EQ(scan("on one core", options).status, 0);
  expect_the_same_bytes("on one core");
}

}  // namespace
}  // namespace dubsar
