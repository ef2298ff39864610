// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Files and disks that are not what they should be: one clear line, the right status, nothing stored lost.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "acquisition/session_store.h"
#include "formats/poses_json.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::bumpy_scan;
using test::Outcome;
using test::run_command;
using test::scan_name;
using test::write_bumpy_scans;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class BadInput : public ::testing::Test {
 protected:
  [[nodiscard]] fs::path at(const char* name) const { return folder_.path() / name; }
  [[nodiscard]] Outcome scan(const fs::path& scans, const char* session,
                             const test::CommandOptions& options = {}) const {
    return run_command(
        {"scan", "--device", "replay:" + scans.string(), "--session", at(session).string(), "--json"},
        options);
  }
  [[nodiscard]] int stored_in(const char* session) const {
    const Outcome listed = run_command({"session", "list", at(session).string(), "--json"});
    return listed.status == 0 ? static_cast<int>(listed.json()["scans"].size()) : -1;
  }
  void expect_whole(const char* session) const {
    const Outcome verified = run_command({"verify", at(session).string()});
    EXPECT_EQ(verified.status, 0) << verified.out << verified.err;
  }

 private:
  test::TemporaryFolder folder_;
};

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

std::string header(const std::string& vertices, const std::string& cells, const std::string& cols = "3",
                   const std::string& rows = "2") {
  return "ply\nformat ascii 1.0\nobj_info num_cols " + cols + "\nobj_info num_rows " + rows +
         "\nelement vertex " + vertices + "\nproperty float x\nproperty float y\nproperty float z\n" +
         "element range_grid " + cells + "\nproperty list uchar int vertex_indices\nend_header\n";
}

TEST_F(BadInput, AFolderWithoutGridsIsTwoAndOneLine) {
  fs::create_directories(at("empty"));
  write_text(at("empty") / "notes.txt", "no scan");
  for (const fs::path& path : {at("empty"), at("nowhere")}) {
    const Outcome outcome = scan(path, "session");
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
    EXPECT_TRUE(outcome.json().contains("error")) << outcome.out;
    EXPECT_EQ(run_command({"register", path.string()}).status, 2);
  }
  EXPECT_FALSE(fs::exists(at("session")));
}

TEST_F(BadInput, OneScanIsCountedAsOne) {
  const Outcome outcome = scan(write_bumpy_scans(at("one"), 1), "session");
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(outcome.json()["verdict"].get<std::string>(), HasSubstr("after 1 scan, 1 registered"));
}

TEST_F(BadInput, OneBadFileDoesNotStopTheOthers) {
  const std::string good = [&] {
    const fs::path folder = write_bumpy_scans(at("good"), 1);
    return test::bytes_of(folder / scan_name(0));
  }();
  const std::string points = "0 0 0\n1 0 0\n2 0 0\n0 1 0\n1 1 0\n2 1 0\n";
  const std::string cells = "1 0\n1 1\n1 2\n1 3\n1 4\n1 5\n";
  const std::vector<std::pair<std::string, std::string>> bad{
      {"empty", ""},
      {"truncated", good.substr(0, good.size() / 2)},
      {"header_only", good.substr(0, 90)},
      {"huge_vertices", header("4000000000000", "6") + points + cells},
      {"huge_grid", header("6", "4000000000000", "2000000", "2000000") + points + cells},
      {"negative", header("-6", "6") + points + cells},
      {"wrong_index", header("6", "6") + points + "1 0\n1 1\n1 2\n1 3\n1 4\n1 99\n"},
      {"disagrees", header("6", "6", "7", "5") + points + cells},
      {"no_ply", "this is no scan at all\n"},
  };
  for (const auto& [name, bytes] : bad) {
    const fs::path folder = at(name.c_str());
    fs::create_directories(folder);
    write_text(folder / "scan.ply", bytes);
    const Outcome outcome = scan(folder, ("alone " + name).c_str());
    EXPECT_EQ(outcome.status, 2) << name << outcome.err;
    EXPECT_THAT(outcome.complaints(), SizeIs(1)) << name << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(folder.string())) << name;
    EXPECT_TRUE(outcome.json().contains("error")) << name << outcome.out;
  }

  const fs::path mixed = write_bumpy_scans(at("mixed"), 3);
  write_text(mixed / "scan_1b.ply", bad[1].second);
  const Outcome outcome = scan(mixed, "mixed session");
  EXPECT_EQ(outcome.status, 2) << outcome.err;
  EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("scan_1b.ply"));
  const auto poses = read_poses(at("mixed session") / "export" / "poses.json");
  ASSERT_TRUE(poses.has_value());
  for (int k = 0; k < 3; ++k) {
    const auto pose =
        std::find_if(poses->begin(), poses->end(), [&](const auto& p) { return p.file == scan_name(k); });
    ASSERT_NE(pose, poses->end()) << k;
    EXPECT_EQ(pose->status, PoseStatus::kRegistered) << k << pose->reason;
  }
  expect_whole("mixed session");

  const Outcome plain = run_command({"register", mixed.string(), "--json"});
  EXPECT_EQ(plain.status, 1) << plain.err;
  EXPECT_THAT(plain.complaints(), SizeIs(1)) << plain.err;
  EXPECT_THAT(plain.json()["scans"], SizeIs(3)) << plain.out;
}

TEST_F(BadInput, NotANumberIsAHole) {
  RangeGrid grid = bumpy_scan(0);
  const std::size_t before = grid.valid_count();
  std::size_t spoilt = 0;
  for (std::size_t i = 0; i < grid.size(); i += 7) {
    if (grid.valid[i] != 0) {
      (i % 2 == 0 ? grid.x : grid.z)[i] =
          i % 3 == 0 ? std::numeric_limits<float>::infinity() : std::numeric_limits<float>::quiet_NaN();
      ++spoilt;
    }
  }
  fs::create_directories(at("nan"));
  ASSERT_TRUE(write_grid_ply(at("nan") / "scan.ply", grid));
  const Outcome outcome = scan(at("nan"), "session");
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  const Outcome listed = run_command({"session", "list", at("session").string(), "--json"});
  ASSERT_EQ(listed.json()["scans"].size(), 1U) << listed.out;
  EXPECT_EQ(listed.json()["scans"][0]["samples"].get<std::size_t>(), before - spoilt);
}

TEST_F(BadInput, ScansThatDoNotOverlapAreNotForcedTogether) {
  fs::create_directories(at("two"));
  ASSERT_TRUE(write_grid_ply(at("two") / "scan_0.ply", bumpy_scan(0, 11)));
  ASSERT_TRUE(write_grid_ply(at("two") / "scan_1.ply", bumpy_scan(1, 77)));
  const Outcome outcome = scan(at("two"), "session");
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  const nlohmann::json second = outcome.json()["poses"]["scans"][1];
  EXPECT_NE(second["status"], "registered");
  EXPECT_FALSE(second["reason"].get<std::string>().empty());
  EXPECT_EQ(run_command({"register", at("two").string()}).status, 1);
}

TEST_F(BadInput, TheUnitIsOfTheFilesNumbers) {
  RangeGrid grid = bumpy_scan(0);
  fs::create_directories(at("metres"));
  const auto written = [&](const char* unit) {
    run_command({"scan", "--device", "replay:" + at("metres").string() + "?unit=" + unit, "--session",
                 at(unit).string()});
    const auto store = SessionStore::open(at(unit), SessionStore::Access::kReadOnly);
    return store ? store->scans()->at(0).spacing_mm : 0.0;
  };
  for (std::vector<float>* axis : {&grid.x, &grid.y, &grid.z}) {
    for (float& value : *axis) {
      value *= 0.001F;
    }
  }
  ASSERT_TRUE(write_grid_ply(at("metres") / "scan.ply", grid));
  // A file of no program of ours says neither its unit nor its spacing.
  std::string bytes = test::bytes_of(at("metres") / "scan.ply");
  for (const char* line : {"obj_info unit", "obj_info dubsar_spacing_mm"}) {
    const std::size_t from = bytes.find(line);
    ASSERT_NE(from, std::string::npos);
    bytes.erase(from, bytes.find('\n', from) + 1 - from);
  }
  write_text(at("metres") / "scan.ply", bytes);
  EXPECT_NEAR(written("m"), 0.4, 0.01);
  EXPECT_NEAR(written("mm"), 0.0004, 0.00001);
  EXPECT_EQ(run_command({"register", at("metres").string(), "--unit", "ell"}).status, 2);
}

TEST_F(BadInput, ADiskThatRefusesLosesNothingStored) {
  fs::create_directories(at("scans"));
  ASSERT_TRUE(write_grid_ply(at("scans") / "scan_0.ply", bumpy_scan(0)));
  ASSERT_TRUE(write_grid_ply(at("scans") / "scan_1.ply", bumpy_scan(1)));
  ASSERT_TRUE(write_grid_ply(at("scans") / "scan_2.ply", bumpy_scan(2, 11, 0.06)));
  test::CommandOptions limited;
  limited.largest_file = fs::file_size(at("scans") / "scan_2.ply") / 10;
  const Outcome outcome = scan(at("scans"), "session", limited);
  EXPECT_EQ(outcome.status, 4) << outcome.err;
  EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
  EXPECT_TRUE(outcome.json().contains("error")) << outcome.out;
  EXPECT_EQ(stored_in("session"), 2);
  expect_whole("session");
}

TEST_F(BadInput, AFolderThatCannotBeWrittenIsOneLine) {
  const fs::path scans = write_bumpy_scans(at("scans"), 1);
  write_text(at("file"), "in the way");
  const Outcome in_the_way = scan(scans, "file");
  EXPECT_THAT(in_the_way.status, ::testing::AnyOf(2, 4)) << in_the_way.err;
  EXPECT_THAT(in_the_way.complaints(), SizeIs(1)) << in_the_way.err;
  fs::create_directories(at("full"));
  write_text(at("full") / "letter.txt", "of somebody");
  const Outcome others = scan(scans, "full");
  EXPECT_EQ(others.status, 2) << others.err;
  EXPECT_THAT(others.complaints(), SizeIs(1)) << others.err;
  // /proc takes no folder from anyone, not even from root.
  const Outcome refused =
      run_command({"scan", "--device", "replay:" + scans.string(), "--session", "/proc/dubsar-session"});
  EXPECT_EQ(refused.status, 4) << refused.err;
  EXPECT_THAT(refused.complaints(), SizeIs(1)) << refused.err;
}

TEST_F(BadInput, ASecondProgramOnTheSessionIsToldSo) {
  const fs::path scans = write_bumpy_scans(at("scans"), 1);
  test::RunningCommand first({"scan", "--device", "replay:" + scans.string() + "?rate=10", "--session",
                              at("session").string(), "-v"});
  for (int tries = 0; tries < 2000 && !fs::exists(at("session") / "session.sqlite"); ++tries) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  const Outcome second = scan(scans, "session");
  EXPECT_EQ(second.status, 4) << second.err;  // wait for it, and try again
  EXPECT_THAT(second.complaints(), SizeIs(1)) << second.err;
  EXPECT_TRUE(second.json().contains("error")) << second.out;
}

/// Exported anew from the first number on, as other programs do it every day.
TEST_F(BadInput, AnotherScanOfANameThatTheSessionHasIsStoredAndSaid) {
  const fs::path first = write_bumpy_scans(at("first"), 2);
  ASSERT_EQ(scan(first, "session").status, 1);
  const fs::path second = write_bumpy_scans(at("second"), 3);
  fs::remove(second / scan_name(0));
  fs::rename(second / scan_name(2), second / scan_name(1));
  const Outcome again = scan(second, "session");
  EXPECT_EQ(again.status, 1) << again.err;
  EXPECT_THAT(again.complaints(), SizeIs(1)) << again.err;
  EXPECT_THAT(again.err, HasSubstr(scan_name(1) + ": the session has another scan of this name"));
  EXPECT_EQ(stored_in("session"), 3);
  for (const fs::path& known : {first, second}) {
    const Outcome same = scan(known, "session");
    EXPECT_EQ(same.status, 1) << "the very same files are known, and no matter";
    EXPECT_THAT(same.complaints(), SizeIs(0)) << same.err;
  }
  EXPECT_EQ(stored_in("session"), 3);
  // The poses tell them apart by their numbers.
  const std::string poses = at("poses.json").string();
  ASSERT_EQ(run_command({"register", at("session").string(), "-o", poses}).status, 0);
  const Outcome mesh = run_command(
      {"stitch", at("session").string(), "--poses", poses, "-o", at("mesh.ply").string(), "--json"});
  EXPECT_EQ(mesh.status, 0) << mesh.err;
  EXPECT_EQ(mesh.json()["scans"], 3) << mesh.err;
}

/// A scanner that exports whole frames has as many samples in every one.
TEST_F(BadInput, AnotherScanIsToldByItsSamplesNotByTheirNumber) {
  fs::create_directories(at("day1"));
  fs::create_directories(at("day2"));
  RangeGrid frame = bumpy_scan(0);
  ASSERT_TRUE(write_grid_ply(at("day1") / scan_name(0), frame));
  for (std::size_t i = 0; i < frame.size(); ++i) {
    frame.z[i] += frame.x[i] > 0 ? 0.02F : 0.0F;
  }
  ASSERT_TRUE(write_grid_ply(at("day2") / scan_name(0), frame));
  (void)scan(at("day1"), "session");
  const Outcome second = scan(at("day2"), "session");
  EXPECT_THAT(second.err, HasSubstr(scan_name(0) + ": the session has another scan of this name"));
  EXPECT_EQ(stored_in("session"), 2);
  (void)scan(at("day2"), "session");
  EXPECT_EQ(stored_in("session"), 2);
}

}  // namespace
}  // namespace dubsar
