// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/device_uri.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "acquisition/told_device.h"
#include "build_paths.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

TEST(DeviceUri, AZeroByteIsRefused) {
  using namespace std::string_view_literals;
  EXPECT_EQ(parse_device_uri("sim\0:"sv).error().kind, ErrorKind::kUsage);
  EXPECT_EQ(parse_device_uri("a\0b"sv).error().kind, ErrorKind::kUsage);
}

TEST(DeviceUri, TakesSchemeLocatorAndOptionsApart) {
  const DeviceUri uri = parse_device_uri("replay:/data/my%20scans?unit=m&rate=20").value();
  EXPECT_EQ(uri.scheme, "replay");
  EXPECT_EQ(uri.locator, "/data/my scans");
  EXPECT_THAT(uri.options, ElementsAre(Pair("unit", "m"), Pair("rate", "20")));
  EXPECT_THAT(parse_device_uri("sim:").value().options, IsEmpty());
  EXPECT_EQ(parse_device_uri("usb_stage:1a86:7523").value().locator, "1a86:7523");
  EXPECT_EQ(parse_device_uri("v4l2:/dev/video0").value().scheme, "v4l2");
  EXPECT_THAT(parse_device_uri("sim:?a=1&&b=x%3Dy&").value().options,
              ElementsAre(Pair("a", "1"), Pair("b", "x=y")));
}

TEST(DeviceUri, ABarePathIsReplayedLetterByLetter) {
  for (const char* path : {"scans", "/a/b.ply", "./odd:name", "50%?", "C:scan", "Sim:x"}) {
    const DeviceUri uri = parse_device_uri(path).value();
    EXPECT_EQ(uri.scheme, "replay") << path;
    EXPECT_EQ(uri.locator, path);
    EXPECT_THAT(uri.options, IsEmpty());
  }
}

TEST(DeviceUri, PeopleAreToldNoFoldersAndWhatIsNoDevice) {
  EXPECT_EQ(told_device("replay:/home/anna/my%20scans/?unit=m"), "replay:my%20scans?unit=m");
  EXPECT_EQ(told_device("/home/anna/scans"), "replay:scans");
  EXPECT_EQ(told_device("rig:../museum.toml"), "rig:museum.toml");
  EXPECT_EQ(told_device("v4l2:/dev/video0"), "v4l2:/dev/video0");
  EXPECT_EQ(told_device("sim:?seed=5"), "sim:?seed=5 (simulated: there is no such tablet)");
  EXPECT_EQ(told_device("sim:?seed"), "sim:?seed") << "what is no device is told as it is";
}

TEST(DeviceUri, RefusesWhatIsBroken) {
  for (const char* text :
       {"", "sim:?seed", "sim:?=4", "sim:?a=1&a=2", "replay:50%", "replay:%zz", "replay:%00"}) {
    const auto uri = parse_device_uri(text);
    ASSERT_FALSE(uri) << text;
    EXPECT_EQ(uri.error().kind, ErrorKind::kUsage);
  }
}

TEST(DeviceUri, FilesAreTheSameOnesFromAnyFolder) {
  const std::string here = std::filesystem::current_path().string();
  EXPECT_EQ(parse_device_uri(absolute_device("rig:./museum.toml")).value().locator, here + "/museum.toml");
  EXPECT_EQ(parse_device_uri(absolute_device("a/../scans")).value().locator, here + "/scans");
  const DeviceUri scans = parse_device_uri(absolute_device("replay:my%20scans?unit=m")).value();
  EXPECT_EQ(scans.locator, here + "/my scans");
  EXPECT_THAT(scans.options, ElementsAre(Pair("unit", "m")));
  for (const char* same :
       {"replay:/data/my%20scans?unit=m", "v4l2:video0", "sim:?seed=5", "rig:", "replay:%zz"}) {
    EXPECT_EQ(absolute_device(same), same);
  }
}

TEST(DeviceUri, TextReadsBackTheSame) {
  const DeviceUri uri{"replay", "/a b/50%?&=#\n\xc3\xbc", {{"unit", "m&m"}, {"r", ""}}};
  const DeviceUri back = parse_device_uri(uri.text()).value();
  EXPECT_EQ(back.scheme, uri.scheme);
  EXPECT_EQ(back.locator, uri.locator);
  EXPECT_EQ(back.options, uri.options);
}

TEST(DeviceUri, WhatCannotBeOpenedIsAnsweredWithTheMend) {
  const DriverRegistry registry({std::filesystem::path(DUBSAR_BINARY_DIR) / "lib/dubsar/drivers"});
  const auto device = open_device(parse_device_uri("webcam:0").value(), registry);
  ASSERT_FALSE(device);
  EXPECT_THAT(device.error().line(), HasSubstr("replay:, sim:"));
  EXPECT_THAT(open_device(parse_device_uri("rig:").value(), registry).error().line(),
              HasSubstr("write rig:FILE"));
  const test::TemporaryFolder folder;
  const std::string rig = (folder.path() / "rig.toml").string();
  std::ofstream(rig) << "name='a'\ncamera='v4l2:/dev/video9'\nstage='usb_stage:1:2'\ncalibration='c.json'\n"
                     << "[scan]\nfrom_mm=0\nto_mm=1\nstep_mm=0.1\n";
  EXPECT_THAT(open_device(parse_device_uri("rig:" + rig).value(), registry).error().line(),
              HasSubstr("the rig has no calibration yet; make it: dubsar calibrate"));
  const auto option = open_device(parse_device_uri("sim:?sede=4").value(), registry);
  ASSERT_FALSE(option);
  EXPECT_THAT(option.error().line(), HasSubstr("takes seed, size, spacing"));
  EXPECT_THAT(option.error().line(), ::testing::Not(HasSubstr("%3F")));
  const auto name = open_device(parse_device_uri("replay:what?x=1").value(), registry);
  ASSERT_FALSE(name);
  EXPECT_THAT(name.error().line(), HasSubstr("replay:what: no option x; "));
  EXPECT_THAT(name.error().line(),
              HasSubstr("in the name of a folder or file write %3F for ? and %25 for %"));
  EXPECT_THAT(parse_device_uri("replay:what?x").error().line(), HasSubstr("write %3F for ?"));
}

}  // namespace
}  // namespace dubsar
