// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

namespace dubsar {
namespace {

struct Outcome {
  std::optional<int> status;
  std::string said;
  double spacing_mm = 0.25;
  std::vector<double> noises;
  int seeds = 4;
  std::uint64_t tablets = 4;
};

Outcome asked(std::vector<const char*> words) {
  words.insert(words.begin(), "dubsar-some");
  Outcome out;
  CLI::App app("A bench", "dubsar-some");
  app.add_option("--spacing", out.spacing_mm)->check(CLI::Range(0.05, 2.0));
  app.add_option("seeds", out.seeds)->check(CLI::Range(1, 100));
  app.add_option("--tablets", out.tablets);
  CLI::App* verb = app.add_subcommand("noise", "");
  verb->add_option("--noises", out.noises);
  testing::internal::CaptureStderr();
  out.status = bench::ends_with(app, static_cast<int>(words.size()), words.data());
  out.said = testing::internal::GetCapturedStderr();
  return out;
}

TEST(BenchOptions, NumbersAreTaken) {
  const Outcome out = asked({"--spacing", "0.5", "--tablets", "3", "7", "noise", "--noises", "0", "1e-3"});
  EXPECT_FALSE(out.status) << out.said;
  EXPECT_EQ(out.spacing_mm, 0.5);
  EXPECT_EQ(out.seeds, 7);
  EXPECT_EQ(out.tablets, 3U);
  EXPECT_THAT(out.noises, testing::ElementsAre(0, 1e-3));
}

TEST(BenchOptions, WhatIsNoNumberIsOneLineAndStatusTwo) {
  for (const std::vector<const char*>& words :
       std::vector<std::vector<const char*>>{{"--spacing", "nan"},
                                             {"--spacing", "inf"},
                                             {"--spacing", "0.5mm"},
                                             {"--spacing", ""},
                                             {"--spacing", "9"},
                                             {"noise", "--noises", "0.1", "-nan"},
                                             {"noise", "--noises", "1e999"},
                                             {"--tablets", "-1"},
                                             {"--tablets=-1"},
                                             {"--tablets", " -1"},
                                             {"seven"},
                                             {"7.5"},
                                             {"--spacings", "1"}}) {
    const Outcome out = asked(words);
    EXPECT_EQ(out.status, 2) << words.back();
    EXPECT_THAT(out.said, testing::StartsWith("dubsar-some: ")) << words.back();
    EXPECT_THAT(out.said, testing::EndsWith("see --help\n")) << words.back();
    EXPECT_EQ(std::count(out.said.begin(), out.said.end(), '\n'), 1) << out.said;
  }
}

}  // namespace
}  // namespace dubsar
