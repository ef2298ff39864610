// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A seed of the fuzz targets that its reader refuses at the door tries nothing of what lies behind it.

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "build_paths.h"
#include "formats/atomic_file.h"
#include "formats/corrections_json.h"
#include "formats/grid_file.h"
#include "formats/pins_json.h"
#include "formats/poses_json.h"
#include "formats/search_index.h"
#include "formats/sign_off_json.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;

/// What the reader says of a seed; empty when it takes it.
template <class T>
std::string said(const Result<T>& read) {
  return read ? std::string() : read.error().line();
}

/// Every seed of a target goes through its reader.
void expect_taken(const char* target, const std::function<std::string(std::string_view)>& refusal) {
  int seeds = 0;
  for (const auto& seed : fs::directory_iterator(fs::path(DUBSAR_SOURCE_DIR) / "fuzz/corpus" / target)) {
    const Result<std::string> bytes = read_whole_file(seed.path());
    ASSERT_TRUE(bytes) << bytes.error().line();
    EXPECT_EQ(refusal(*bytes), "") << seed.path();
    ++seeds;
  }
  EXPECT_GT(seeds, 0) << target;
}

TEST(FuzzSeeds, GridsAreGrids) {
  expect_taken("grid", [](std::string_view bytes) {
    return said(decode_grid(std::as_bytes(std::span(bytes)), "seed"));
  });
}

TEST(FuzzSeeds, TheSearchIndexIsOfThisVersion) {
  expect_taken("search_index",
               [](std::string_view bytes) { return said(parse_search_index(bytes, "seed")); });
}

TEST(FuzzSeeds, DocumentsAreTaken) {
  expect_taken("corrections", [](std::string_view bytes) { return said(parse_corrections(bytes, "seed")); });
  expect_taken("pins", [](std::string_view bytes) { return said(parse_pins(bytes, "seed")); });
  expect_taken("poses", [](std::string_view bytes) { return said(parse_poses(bytes, "seed")); });
  expect_taken("sign_off",
               [](std::string_view bytes) { return said(parse_recorded_sign_off(bytes, "seed")); });
}

}  // namespace
}  // namespace dubsar
