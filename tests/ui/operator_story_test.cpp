// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The whole of an operator's day, by keys and clicks in the real window: a scan that is unsure, one that is
// taken out and put back, the verdict, the signature.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <tuple>

#include "acquisition/session_store.h"
#include "formats/pins_json.h"
#include "station/session_pins.h"
#include "station/tablet_record.h"
#include "tests/station/support/command.h"
#include "tests/station/support/two_fold_scans.h"
#include "tests/ui/support/on_a_display.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::run_command;

constexpr const char* kSmallTablet = "sim:?seed=1&size=20x16x8&spacing=0.2&noise=0.02";
/// Of which the fourth scan fits nowhere for certain until the fifth has come.
constexpr const char* kAskingTablet = "sim:?seed=12&size=20x16x8&spacing=0.2&noise=0.02";

class OperatorStory : public test::OnADisplay {
 protected:
  Outcome play(const std::string& script) { return play_on(kSmallTablet, script); }
  /// Without a device: on the one that the window takes by itself.
  Outcome play_on(const std::string& device, const std::string& script) {
    const fs::path file = folder_.path() / "story.script";
    std::ofstream(file) << script;
    std::vector<std::string> words{"station", "--session", session() + "/", "--script", file.string()};
    if (!device.empty()) {
      words.insert(words.end(), {"--device", device});
    }
    return run_command(words);  // the session as a shell completes it
  }
  [[nodiscard]] std::string session() const { return (folder_.path() / "session").string(); }
};

constexpr const char* kStory = R"(
wait idle
expect scan
key space
wait waiting-turn
key space
wait scans.3
wait waiting-turn
key space
# a scan that fits nowhere for certain is not taken up in silence
wait waiting-unsure
expect scan.3.unsure
key p
wait pair-left
click pairs-close
key space
wait waiting-turn
expect scan.3.fits
# out, and back again
key backspace
wait scan.4.taken out
wait waiting
click scan.4
click restore
wait scan.4.fits
wait waiting-turn
key space
wait waiting-turn
key space
wait idle 120
expect conclusive
key enter
wait sign-name
pause 0.2
type A. Reader
key enter
wait signed
)";

/// What comes after it: the package, and the next tablet.
constexpr const char* kAfterwards = R"(
expect statement-whole
key f11
wait package-now
pause 0.2
key f11
wait packed 120
wait idle
key space
wait next-now
pause 0.2
key escape
pause 0.2
click tablet
wait next-tablet
pause 0.2
key n
wait next-now
pause 0.2
key enter
wait scans.0
wait idle
expect scan
key space
wait scans.1 60
quit
)";

/// Keys, clicks and typed lines of a script, without the key that follows each turn by hand.
int presses_beyond_turns(const std::string& script) {
  int presses = 0;
  bool turned = false;
  std::istringstream lines(script);
  for (std::string line; std::getline(lines, line);) {
    const bool press = line.starts_with("key ") || line.starts_with("click ") || line.starts_with("type ");
    presses += press && !(turned && line == "key space") ? 1 : 0;
    turned = line == "wait waiting-turn" || (turned && !press);
  }
  return presses;
}

TEST_F(OperatorStory, FromTheFirstKeyToASignedConclusiveTablet) {
  EXPECT_LE(presses_beyond_turns(kStory), 12);
  const Outcome played = play_on(kAskingTablet, std::string(kStory) + kAfterwards);
  ASSERT_EQ(played.status, 0) << played.err;
  EXPECT_TRUE(fs::exists(session() + "-2/session.sqlite")) << "the next tablet's lies beside it";
  EXPECT_EQ(run_command({"verify", session() + ".results/package"}).status, 0);
  const auto again = run_command({"export", session(), "--to", session() + ".results/package", "--json"});
  EXPECT_EQ(again.json()["done_before"], true) << "the command makes the same";
  const auto list = run_command({"session", "list", session(), "--json"}).json();
  ASSERT_EQ(list["sign_offs"].size(), 1U);
  EXPECT_EQ(list["sign_offs"][0]["name"], "A. Reader");
  EXPECT_EQ(list["sign_offs"][0]["conclusive"], true);
  EXPECT_EQ(run_command({"verify", session()}).status, 0);
  EXPECT_EQ(run_command({"plan", session(), "--json"}).json()["conclusive"], true);
}

TEST_F(OperatorStory, WhatIsTypedOfTheTabletIsKeptWhereTheWindowIsClosedBeforeItsLineIsLeft) {
  const Outcome typed = play("wait idle\nclick tablet\nclick museum-number\ntype VAT 7\npause 0.5\nquit\n");
  ASSERT_EQ(typed.status, 0) << typed.err;
  const Result<SessionStore> store = SessionStore::open(session(), SessionStore::Access::kReadOnly);
  ASSERT_TRUE(store) << store.error().line();
  EXPECT_EQ(tablet_record_of(*store).museum_number, "VAT 7");
}

TEST_F(OperatorStory, WhatIsSaidOfTheTabletIsKeptAndAClosedWindowGoesOn) {
  const Outcome first = play(R"(
wait idle
click tablet
click museum-number
type VAT 12345
click cdli
type P1234
pause 0.2
click cdli
type 56
click close-tablet
key space
wait waiting-turn
quit
)");
  ASSERT_EQ(first.status, 0) << first.err;
  // The window was closed in the middle of a run: what was stored is there, and it goes on.
  const auto list = run_command({"session", "list", session(), "--json"}).json();
  ASSERT_GE(list["scans"].size(), 2U);
  const Outcome second = play(R"(
wait scan.1.fits
wait model-shown
wait idle
expect scan.0.fits
key space
wait waiting
wait scans.3
quit
)");
  ASSERT_EQ(second.status, 0) << second.err;
}

/// Where a point of the surface stands in the picture of a grid, "0.42 0.37".
std::string place_in(const RangeGrid& grid, const Eigen::Vector3d& point) {
  std::size_t best = 0;
  double nearest = 1e9;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const double far = grid.valid[i] != 0 ? (grid.point(i).cast<double>() - point).norm() : 1e9;
    if (far < nearest) {
      nearest = far;
      best = i;
    }
  }
  const double u = (grid.col_of(best) + 0.5) / grid.cols;
  const double v = (grid.row_of(best) + 0.5) / grid.rows;
  return std::to_string(u) + " " + std::to_string(v);
}

TEST_F(OperatorStory, ClicksOnTheSamePlaceSettleAnUnsureScan) {
  // A surface that fits itself turned by half: only somebody who knows it can say which way round.
  const fs::path scans = folder_.path() / "scans";
  test::write_two_fold_scans(scans);
  const Eigen::Vector3d p(14, -9, test::two_fold_surface()(14, -9));
  const auto grid_of = [](int number) {
    testing::FieldScan scan;
    scan.seed = 1 + 8 * static_cast<std::uint64_t>(number);
    return testing::scan_field(test::two_fold_surface(), test::two_fold_pose(number), scan);
  };
  const std::string left = place_in(grid_of(1), test::two_fold_pose(1).inverse() * p);
  const std::string right = place_in(grid_of(0), p);
  const Outcome played = play_on("replay:" + scans.string(),
                                 "wait idle\nkey space\nwait scan.1.unsure\nwait idle 90\n"
                                 "click scan.1\nclick pairs\nwait pair-left\n"
                                 "click pair-left " +
                                     left + "\nclick pair-right " + right +
                                     "\nclick pairs-done\nwait scan.1.fits\nwait idle 90\nquit\n");
  ASSERT_EQ(played.status, 0) << played.err;
  const auto list = run_command({"session", "list", session(), "--json"}).json();
  EXPECT_EQ(list["scans"][1]["status"], "registered");
  EXPECT_EQ(list["scans"][1]["hint_on"], 0);
  // The places can be taken back.
  const Outcome withdrawn = play_on("replay:" + scans.string(),
                                    "wait scan.1.fits\nwait idle 90\nclick scan.1\nclick withdraw\n"
                                    "wait idle 90\nquit\n");
  ASSERT_EQ(withdrawn.status, 0) << withdrawn.err;
  const auto after = run_command({"session", "list", session(), "--json"}).json();
  EXPECT_TRUE(after["scans"][1]["hint_on"].is_null());
}

TEST_F(OperatorStory, LabelledPlacesOnTheRimSettleAnUnsureScan) {
  // As above, and no pin stands anywhere: three places that have names in both scans tell how they lie.
  const fs::path scans = folder_.path() / "scans";
  test::write_two_fold_scans(scans);
  std::string clicks;
  std::map<std::string, Eigen::Vector3d> places;
  for (const auto& [label, x, y] :
       {std::tuple("A", 14, -9), std::tuple("B", -12, -4), std::tuple("C", 3, 11)}) {
    places[label] = {double(x), double(y), test::two_fold_surface()(x, y)};
    const auto grid_of = [](int number) {
      testing::FieldScan scan;
      scan.seed = 1 + 8 * static_cast<std::uint64_t>(number);
      return testing::scan_field(test::two_fold_surface(), test::two_fold_pose(number), scan);
    };
    clicks += std::string("click label.") + label + "\nclick pins-left " +
              place_in(grid_of(1), test::two_fold_pose(1).inverse() * places[label]) + "\nclick pins-right " +
              place_in(grid_of(0), places[label]) + "\n";
  }
  const Outcome played = play_on("replay:" + scans.string(),
                                 "wait idle\nkey space\nwait scan.1.unsure\nwait idle 90\n"
                                 "click scan.1\nclick label-pins\nwait pins-right\n" +
                                     clicks +
                                     "click pins-done\nwait scan.1.fits 120\nwait scan.0.pins.3\n"
                                     "expect scan.1.pins.3\nwait idle 90\nquit\n");
  ASSERT_EQ(played.status, 0) << played.err;
  const Result<SessionStore> store = SessionStore::open(session(), SessionStore::Access::kReadOnly);
  ASSERT_TRUE(store.has_value());
  const auto pins = session_pins(*store);
  ASSERT_TRUE(pins && *pins);
  ASSERT_EQ((*pins)->tips.at(0).size(), 3U);
  for (const PinTip& tip : (*pins)->tips.at(0)) {
    const std::string label(1, static_cast<char>('A' + tip.label - 101));
    EXPECT_LT((tip.position_mm - places.at(label)).norm(), 1.0) << label;
  }
  // The same labels, and the same poses, for the command line.
  const auto registered = run_command({"register", session(), "--json"}).json();
  EXPECT_EQ(registered["scans"][1]["status"], "registered");
}

TEST_F(OperatorStory, AClickOnATipIsTheCentreOfItsBall) {
  const fs::path truth = folder_.path() / "truth";
  const std::string device = std::string(kSmallTablet) + "&pins=1&truth=" + truth.string();
  const Outcome scanned = play_on(device, "wait idle\nkey space\nwait waiting-turn\nquit\n");
  ASSERT_EQ(scanned.status, 0) << scanned.err;
  const Result<PinSet> tips = read_pins(truth / "truth_pins.json");
  ASSERT_TRUE(tips && !tips->tips.at(0).empty());
  const PinTip tip = tips->tips.at(0).front();
  std::string click;
  {
    const Result<SessionStore> store = SessionStore::open(session(), SessionStore::Access::kReadOnly);
    ASSERT_TRUE(store.has_value());
    const Result<RangeGrid> grid = store->load_grid(0);
    ASSERT_TRUE(grid.has_value());
    const Eigen::Vector3d seen =
        tip.position_mm +
        0.5 * tips->tip_diameter_mm * grid->view.to_camera(tip.position_mm, 0.5 * grid->rows);
    click = place_in(*grid, seen);
  }
  const Outcome labelled =
      play_on(device,
              "wait scan.0.fits\nwait idle\nclick scan.0\nclick label-pins\n"
              "wait pins-left\nclick label.7\nclick pins-left " +
                  click +
                  "\nclick pins-done\nwait scan.0.pins.1\nwait waiting\nwait pin.7\nclick viewer\n"
                  "wait whole\nexpect pin.7\nclick show-pins\nexpect show-pins\nquit\n");
  ASSERT_EQ(labelled.status, 0) << labelled.err;
  const Result<SessionStore> store = SessionStore::open(session(), SessionStore::Access::kReadOnly);
  ASSERT_TRUE(store.has_value());
  const auto pins = session_pins(*store);
  ASSERT_TRUE(pins && *pins);
  EXPECT_EQ((*pins)->tip_diameter_mm, tips->tip_diameter_mm);
  ASSERT_EQ((*pins)->tips.at(0).size(), 1U);
  EXPECT_EQ((*pins)->tips.at(0)[0].label, 7);
  EXPECT_LT(((*pins)->tips.at(0)[0].position_mm - tip.position_mm).norm(), 0.5);
}

TEST_F(OperatorStory, EscapeShutsWhatIsOpenAndStopsNothing) {
  const Outcome played = play(R"(
wait idle
click settings
wait close-settings
key escape
pause 0.2
expect scan
key space
wait waiting-turn
click scan.0
wait drop
# neither of these is for the engine while the menu asks
key space
pause 0.3
expect waiting-turn
key escape
pause 0.5
expect waiting-turn
quit
)");
  EXPECT_EQ(played.status, 0) << played.err;
}

/// Whatever is open, and wherever the run is; what came is kept, and space goes on.
TEST_F(OperatorStory, TheEmergencyStopEndsTheRunAndSpaceGoesOn) {
  const Outcome outcome = play(
      "wait idle\nkey space\nwait emergency-stop\nclick settings\nhalt\nwait stopped\nwait idle\n"
      "key escape\nkey space\nwait waiting\nkey f12\nwait stopped\nwait idle\nquit\n");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(OperatorStory, TheListOfScannersBeginsWithTheOneInUse) {
  // It was another, without its options, as soon as the list was looked at.
  const std::string finds_it =
      "wait idle\nclick device\nwait driver.sim\npause 0.3\nwait address." + std::string(kSmallTablet);
  const Outcome played = play(finds_it + "\nclick use-device\nkey space\nwait waiting-turn\nquit\n");
  ASSERT_EQ(played.status, 0) << played.err;
  const auto list = run_command({"session", "list", session(), "--json"}).json();
  EXPECT_GE(list["scans"].size(), 1U);
  // And when the session is opened again and nobody says which.
  const Outcome again = play_on("", finds_it + "\nquit\n");
  EXPECT_EQ(again.status, 0) << again.err;
}

TEST_F(OperatorStory, SayingWhatTabletItIsOpensNoScanner) {
  const Outcome scanned = play("wait idle\nkey space\nwait waiting-turn\nquit\n");
  ASSERT_EQ(scanned.status, 0) << scanned.err;
  const auto before = run_command({"session", "list", session(), "--json"}).json()["scans"].size();
  // While the model of the session that was left is being made again.
  const Outcome played = play(
      "wait scan.0.fits\nclick tablet\nclick museum-number\ntype VAT 7\nclick close-tablet\nwait idle 60\n"
      "pause 0.5\nexpect still\nquit\n");
  ASSERT_EQ(played.status, 0) << played.err;
  EXPECT_EQ(run_command({"session", "list", session(), "--json"}).json()["scans"].size(), before);
  const Result<SessionStore> store = SessionStore::open(session(), SessionStore::Access::kReadOnly);
  ASSERT_TRUE(store.has_value());
  EXPECT_EQ(tablet_record_of(*store).museum_number, "VAT 7");
}

TEST_F(OperatorStory, CuneiformStaysAsItIsWhenALineIsTypedInto) {
  const Outcome scanned = play("wait idle\nkey space\nwait waiting-turn\nquit\n");
  ASSERT_EQ(scanned.status, 0) << scanned.err;
  const std::string number = "BM 𒀭 15285";
  const std::string notes = "obv. 1: 𒁹𒀀 𒈗 the king 𝄞";
  const Outcome told =
      run_command({"session", "describe", session(), "--museum-number", number, "--notes", notes});
  ASSERT_EQ(told.status, 0) << told.err;
  const Outcome played = play(
      "wait scan.0.fits\nclick tablet\nclick notes\nkey end\ntype 𒁇X\nclick close-tablet\npause 0.5\n"
      "expect still\nquit\n");
  ASSERT_EQ(played.status, 0) << played.err;
  const Result<SessionStore> store = SessionStore::open(session(), SessionStore::Access::kReadOnly);
  ASSERT_TRUE(store.has_value());
  EXPECT_EQ(tablet_record_of(*store).museum_number, number);
  EXPECT_EQ(tablet_record_of(*store).notes, notes + "𒁇X");
}

TEST_F(OperatorStory, TonesAreOffUntilTheyAreTicked) {
  // A player that writes down that it was called.
  const fs::path players = folder_.path() / "players";
  const fs::path heard = folder_.path() / "heard";
  fs::create_directories(players);
  for (const char* name : {"pw-play", "paplay", "aplay"}) {
    std::ofstream(players / name) << "#!/bin/sh\nhead -c 4 \"$1\" >> " << heard.string() << "\n";
    fs::permissions(players / name, fs::perms::owner_all);
  }
  const char* path = std::getenv("PATH");
  ASSERT_NE(path, nullptr);
  const std::string before = path;
  setenv("PATH", (players.string() + ":" + before).c_str(), 1);
  const Outcome silent = play("wait idle\nkey space\nwait waiting-turn\nquit\n");
  const bool heard_silence = !fs::exists(heard);
  const Outcome loud = play(
      "wait scan.0.fits\nwait idle\nclick settings\nclick sound\nclick close-settings\n"
      "pause 0.5\nkey space\nwait waiting\npause 0.5\nquit\n");
  setenv("PATH", before.c_str(), 1);
  EXPECT_EQ(silent.status, 0) << silent.err;
  EXPECT_TRUE(heard_silence);
  ASSERT_EQ(loud.status, 0) << loud.err;
  std::ifstream in(heard);
  const std::string tones{std::istreambuf_iterator<char>(in), {}};
  EXPECT_THAT(tones, ::testing::StartsWith("RIFFRIFF"))
      << "when it was ticked, and when the turn was asked for";
}

}  // namespace
}  // namespace dubsar
