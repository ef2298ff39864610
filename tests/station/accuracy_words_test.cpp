// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/accuracy_words.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dubsar {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

ScanPose pose(int id, double rms_mm, double overlap, PoseStatus status = PoseStatus::kRegistered) {
  ScanPose out;
  out.id = id;
  out.status = status;
  out.rms_mm = rms_mm;
  out.sigma_mm = 0.5 * rms_mm;
  out.overlap = overlap;
  return out;
}

PlacedScan placed(int id, double noise_mm) {
  PlacedScan out;
  out.id = id;
  out.noise_mm = noise_mm;
  return out;
}

TEST(AccuracyWords, OneScanIsNotSaidToAgreeWithOthers) {
  EXPECT_THAT(accuracy_sentences({}, {}, {}), IsEmpty());
  EXPECT_THAT(accuracy_sentences({pose(0, 0, 0, PoseStatus::kFailed)}, {}, {}), IsEmpty());
  EXPECT_THAT(accuracy_sentences({pose(0, 0, 0), pose(1, 0.03, 0.2, PoseStatus::kUnsure)}, {}, {}),
              ElementsAre(HasSubstr("One scan is in the model: there is no other")));
  EXPECT_THAT(accuracy_sentences({pose(0, 0, 0), pose(1, 0, 0)}, {}, {}),
              ElementsAre(HasSubstr("No two scans of the model overlap")));
}

TEST(AccuracyWords, TellTheWorstOfThoseThatCount) {
  EXPECT_THAT(
      accuracy_sentences({pose(0, 0.01, 0.7), pose(1, 0.02, 0.6), pose(2, 0.9, 0.1, PoseStatus::kUnsure)}, {},
                         {}),
      ElementsAre(HasSubstr("within 20.0 µm RMS of each other"), HasSubstr("at most 10.0 µm (one standard")));
}

/// What seed and archives ask of a report: the scanner's own noise, which is in no residual by itself.
TEST(AccuracyWords, TellHowFarSamplesScatter) {
  const std::vector<PlacedScan> one = {placed(0, 0.0104), placed(1, 0)};
  EXPECT_THAT(accuracy_sentences({}, one, {}),
              ElementsAre("From sample to sample a scan scatters by 10.4 µm along its view (noise, one "
                          "standard deviation)."))
      << "of the other nothing can be told";
  const std::vector<PlacedScan> several = {placed(0, 0.011), placed(1, 0.009), placed(2, 0.0303)};
  EXPECT_THAT(accuracy_sentences({}, several, {}),
              ElementsAre(HasSubstr("scatters by 11.0 µm along its view (noise, one standard deviation, "
                                    "median of 3 scans; 30.3 µm in the worst)")));
}

}  // namespace
}  // namespace dubsar
