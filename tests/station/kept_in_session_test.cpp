// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a session keeps beside its scans, as earlier versions left it: wedges of another method, devices as
// given.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "acquisition/device_uri.h"
#include "sim/tablet.h"
#include "station/device_panel.h"
#include "station/session_wedges.h"
#include "tests/support/raster_mesh.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

class KeptInSession : public ::testing::Test {
 protected:
  test::TemporaryFolder folder_;
  SessionStore store_ = SessionStore::open_or_create(folder_.path() / "s").value();
};

TEST_F(KeptInSession, WedgesOfAnotherMethodAreMeasuredAnew) {
  const Mesh mesh = test::blank_square();
  ASSERT_TRUE(keep_wedges(store_, mesh, {}).value());
  ASSERT_TRUE(stored_wedges(store_, mesh, {}));
  nlohmann::json document = nlohmann::json::parse(store_.load_document("wedges").value().value());
  document["method"] = document["method"].get<int>() - 1;
  ASSERT_TRUE(store_.save_document("wedges", document.dump()));
  EXPECT_FALSE(stored_wedges(store_, mesh, {}));
  document.erase("method");  // before there was a second one
  ASSERT_TRUE(store_.save_document("wedges", document.dump()));
  EXPECT_FALSE(stored_wedges(store_, mesh, {}));
}

TEST_F(KeptInSession, WedgesThatAreMeasuredAnewKeepTheirIds) {
  sim::TabletOptions options;
  options.seed = 5;
  options.size_mm = {14, 11, 8};
  options.spacing_mm = 0.2;
  JobContext job;
  const Mesh mesh = sim::make_tablet(options, job)->mesh;
  ASSERT_TRUE(keep_wedges(store_, mesh, {}).value());
  const auto path = store_.folder() / "analysis/wedges.json";
  WedgeFile file = read_wedges(path).value();
  ASSERT_GT(file.wedges.size(), 1U);
  EXPECT_EQ(file.wedges.front().id, 0);
  for (Wedge& wedge : file.wedges) {
    wedge.id = 50 - wedge.id;
  }
  ASSERT_TRUE(
      store_.replace_file("analysis/wedges.json", [&](const auto& to) { return write_wedges(to, file); }));
  ASSERT_TRUE(keep_wedges(store_, mesh, {}).value());
  const WedgeFile again = read_wedges(path).value();
  ASSERT_EQ(again.wedges.size(), file.wedges.size());
  for (const Wedge& wedge : file.wedges) {
    const auto same = std::ranges::find(again.wedges, wedge.id, &Wedge::id);
    ASSERT_NE(same, again.wedges.end()) << wedge.id;
    EXPECT_EQ(same->depth_point_mm, wedge.depth_point_mm);
  }
  // What an export measures goes by them, too.
  const std::optional<WedgeFile> measured =
      measure_wedges(mesh, {}, session_known_wedges(store_), {}).value();
  ASSERT_TRUE(measured);
  EXPECT_EQ(measured->wedges.front().id, again.wedges.front().id);
}

TEST_F(KeptInSession, DevicesStayAsEarlierVersionsKeptThem) {
  const std::string old = R"({"devices":[
    {"uri":"replay:scans","settings":[{"key":"rate","value":"5"}]},
    {"uri":"replay:others","settings":[]}]})";
  ASSERT_TRUE(store_.save_document("device_settings", old));
  EXPECT_EQ(own_device(store_).value(), "replay:others");
  EXPECT_THAT(kept_settings(store_, "replay:scans").value(), ElementsAre(Pair("rate", "5")));
  EXPECT_THAT(kept_settings(store_, absolute_device("replay:scans")).value(), ElementsAre(Pair("rate", "5")));
  // What is kept of another device says nothing new of where these two are.
  ASSERT_TRUE(keep_settings(store_, "sim:?seed=1", {{"noise", "0"}}));
  nlohmann::json devices = nlohmann::json::parse(store_.load_document("device_settings").value().value());
  ASSERT_EQ(devices["devices"].size(), 3U);
  EXPECT_EQ(devices["devices"][0]["uri"], "replay:scans");
  EXPECT_EQ(own_device(store_).value(), "sim:?seed=1");
  // The device itself, opened once more, takes the place of its old entry.
  ASSERT_TRUE(keep_settings(store_, "replay:scans", {{"rate", "6"}}));
  devices = nlohmann::json::parse(store_.load_document("device_settings").value().value());
  ASSERT_EQ(devices["devices"].size(), 3U);
  EXPECT_EQ(own_device(store_).value(), absolute_device("replay:scans"));
  EXPECT_THAT(kept_settings(store_, "replay:scans").value(), ElementsAre(Pair("rate", "6")));
}

TEST_F(KeptInSession, ASettingOfAnotherDeviceDoesNotMakeItTheSessionsOwn) {
  // Without a scan, the session goes on with what was touched last.
  ASSERT_TRUE(note_settings(store_, "plate:1", {{"rate", "5"}}));
  ASSERT_TRUE(note_settings(store_, "plate:2", {}));
  EXPECT_EQ(own_device(store_).value(), "plate:2");
  RangeGrid grid;
  grid.allocate(1, 1);
  ASSERT_TRUE(store_.add_grid(grid));
  ASSERT_TRUE(note_settings(store_, "plate:1", {{"rate", "6"}}));
  ASSERT_TRUE(note_settings(store_, "plate:3", {{"rate", "7"}}));
  EXPECT_EQ(own_device(store_).value(), "plate:2");
  EXPECT_THAT(kept_settings(store_, "plate:1").value(), ElementsAre(Pair("rate", "6")));
  EXPECT_THAT(kept_settings(store_, "plate:3").value(), ElementsAre(Pair("rate", "7")));
  ASSERT_TRUE(keep_settings(store_, "plate:3", {}));
  EXPECT_EQ(own_device(store_).value(), "plate:3");
}

}  // namespace
}  // namespace dubsar
