// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a session says the tablet was scanned with is what its scans were scanned with, whatever was tried
// since.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "acquisition/session_store.h"
#include "build_paths.h"
#include "core/pin_set.h"
#include "station/device_panel.h"
#include "station/engine.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;

/// A tablet that is gone before the first row of each scan.
constexpr const char* kOfNothing = "sim:?seed=3&size=20x16x10&spacing=0.2&intrude=gone@0-50";

class EngineOrigin : public ::testing::Test {
 protected:
  void SetUp() override { ::setenv("DUBSAR_DRIVER_PATH", DUBSAR_BINARY_DIR "/lib/dubsar/drivers", 1); }
  Result<EngineResult> run(const std::string& device, const SettingWords& settings = {},
                           const std::optional<PinSet>& pins = std::nullopt) const {
    EngineOptions options;
    options.device = device;
    options.session = session_;
    options.settings = settings;
    options.pins = pins;
    Engine engine(options, nullptr);
    JobContext job;
    return engine.run(job);
  }
  /// All that the session keeps of what it was scanned with.
  [[nodiscard]] std::map<std::string, std::string> origin() const {
    const SessionStore store = SessionStore::open(session_, SessionStore::Access::kReadOnly).value();
    std::map<std::string, std::string> out;
    const std::vector<std::string> names = store.document_names().value();
    for (const std::string& name : names) {
      if (name == "rig" || name == "pins" || name == "device_settings" || name == "range_camera" ||
          name.starts_with("calibration")) {
        out[name] = store.load_document(name).value().value();
      } else if (name == "run") {
        out[name] = nlohmann::json::parse(store.load_document(name).value().value())["device"];
      }
    }
    return out;
  }
  [[nodiscard]] std::size_t stored() const {
    return SessionStore::open(session_, SessionStore::Access::kReadOnly).value().scans()->size();
  }
  test::TemporaryFolder folder_;
  fs::path session_ = folder_.path() / "s";
};

TEST_F(EngineOrigin, ARunThatStoresNothingLeavesWhatWasScannedWith) {
  const std::string scans = "replay:" + test::write_bumpy_scans(folder_.path() / "scans", 2).string();
  ASSERT_TRUE(run(scans + "?unit=mm"));
  const auto before = origin();
  EXPECT_EQ(before.at("run"), "replay:scans?unit=mm");
  EXPECT_FALSE(before.contains("rig"));
  // The same files in another unit are left out; a run of them comes to a verdict all the same.
  ASSERT_TRUE(run(scans + "?unit=m", {{"rate", "5000"}}));
  EXPECT_EQ(origin(), before);
  // A device with a rig and pins of its own, before which nothing stands.
  ASSERT_TRUE(run(kOfNothing, {}, PinSet{1.0, {{0, {{1, {1, 2, 3}}}}}}));
  EXPECT_EQ(origin(), before);
  EXPECT_EQ(stored(), 2U);
}

TEST_F(EngineOrigin, TheFirstScanThatIsStoredSaysWhatItWasScannedWith) {
  const std::string scans = "replay:" + test::write_bumpy_scans(folder_.path() / "scans", 1).string();
  ASSERT_TRUE(run(scans));
  const std::string device = "sim:?seed=3&size=20x16x10&spacing=0.4";
  ASSERT_TRUE(run(device, {}, PinSet{1.0, {{0, {{1, {1, 2, 3}}}}}}));
  const auto after = origin();
  EXPECT_EQ(stored(), 2U);
  EXPECT_TRUE(after.contains("rig"));
  EXPECT_TRUE(after.contains("pins"));
  EXPECT_THAT(after.at("run"), ::testing::StartsWith(device));
  const SessionStore store = SessionStore::open(session_, SessionStore::Access::kReadOnly).value();
  EXPECT_EQ(own_device(store).value(), device);
}

TEST_F(EngineOrigin, SettingsAreKeptWithTheFirstScanThatIsStored) {
  const std::string one = "replay:" + test::write_bumpy_scans(folder_.path() / "one", 1).string();
  const std::string two = "replay:" + test::write_bumpy_scans(folder_.path() / "two", 2).string();
  ASSERT_TRUE(run(one));
  ASSERT_TRUE(run(two, {{"rate", "5000"}}));
  EXPECT_EQ(stored(), 2U);
  const SessionStore store = SessionStore::open(session_, SessionStore::Access::kReadOnly).value();
  EXPECT_EQ(own_device(store).value(), two);
  EXPECT_THAT(kept_settings(store, two).value(), ::testing::ElementsAre(::testing::Pair("rate", "5000")));
}

TEST_F(EngineOrigin, AWrongFirstDeviceLeavesNoRigBehind) {
  EXPECT_FALSE(run(kOfNothing));
  EXPECT_FALSE(origin().contains("rig"));
  ASSERT_TRUE(run("replay:" + test::write_bumpy_scans(folder_.path() / "scans", 1).string()));
  EXPECT_FALSE(origin().contains("rig"));
  EXPECT_EQ(origin().at("run"), "replay:scans");
}

/// They are of the scans that the session has.
TEST_F(EngineOrigin, PinsOfScansThatAreThereAreKept) {
  const std::string scans = "replay:" + test::write_bumpy_scans(folder_.path() / "scans", 1).string();
  ASSERT_TRUE(run(scans));
  EXPECT_FALSE(origin().contains("pins"));
  ASSERT_TRUE(run(scans, {}, PinSet{1.0, {{0, {{1, {1, 2, 3}}}}}}));
  EXPECT_EQ(stored(), 1U);
  EXPECT_TRUE(origin().contains("pins"));
}

}  // namespace
}  // namespace dubsar
