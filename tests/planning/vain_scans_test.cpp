// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/vain_scans.h"

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

namespace dubsar {
namespace {

RedMap red(std::initializer_list<double> areas_mm2, const std::string& reason = {}) {
  RedMap map;
  for (const double area_mm2 : areas_mm2) {
    map.regions.emplace_back();
    map.regions.back().area_mm2 = area_mm2;
    map.regions.back().reason = reason;
  }
  return map;
}

TEST(VainScans, ThreeThatClearNothingOfOneCavityAreEnough) {
  // A hole of radius 1 mm and 6 mm deep, as a session had it: predicted 4.3, 3.4 and 2.4.
  VainScans scans;
  EXPECT_FALSE(scans.after(red({8.0}), std::nullopt, 0));
  EXPECT_FALSE(scans.after(red({10.4}), 4.3, 0.0));
  EXPECT_FALSE(scans.after(red({10.9}), 3.4, 0.0));
  EXPECT_TRUE(scans.after(red({10.2, 0.6}), 2.4, 1.9));
  EXPECT_FALSE(scans.after(red({3.0}), 1.7, 1.7)) << "it does get on";
}

TEST(VainScans, WhatGivesNoSignalMayBeSeveralPlaces) {
  for (const bool silent : {false, true}) {
    VainScans scans;
    bool last = false;
    for (int k = 0; k < 4; ++k) {
      last = scans.after(red({5, 5, 5}, silent ? "gives no signal" : ""), 4.0, 0.1);
    }
    EXPECT_EQ(last, silent);
  }
}

TEST(VainScans, ASessionThatGetsOnIsLeftAlone) {
  VainScans scans;
  for (const double area_mm2 : {800.0, 500.0, 300.0, 100.0, 60.0, 50.0, 20.0, 5.0}) {
    EXPECT_FALSE(scans.after(red({area_mm2}), 100.0, 95.0)) << area_mm2;
  }
  // The first scans show how large the tablet is: red grows, though they clear what they should.
  for (const double area_mm2 : {255.0, 908.0, 927.0, 927.0}) {
    EXPECT_FALSE(scans.after(red({area_mm2}), 45.0, 43.0)) << area_mm2;
  }
  RedMap done;
  done.conclusive = true;
  EXPECT_FALSE(scans.after(done, 5.0, 0.0));
}

TEST(VainScans, ScansThatWereNotAskedForDoNotCount) {
  VainScans scans;
  for (int k = 0; k < 6; ++k) {
    EXPECT_FALSE(scans.after(red({8.0}), std::nullopt, 0));
  }
}

}  // namespace
}  // namespace dubsar
