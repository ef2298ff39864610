// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {

namespace test {

/// Relative, in name order.
inline std::vector<std::string> files_below(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      names.push_back(entry.path().lexically_relative(folder).generic_string());
    }
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace test

/// A session of three scans of one side, and its package, for all tests of a suite.
class Export : public ::testing::Test {
 protected:
  static void scan_session() {
    folder_ = new test::TemporaryFolder;
    const std::filesystem::path scans = test::write_bumpy_scans(at("scans"), 3);
    const test::Outcome scanned = test::run_command(
        {"scan", "--device", "replay:" + scans.string(), "--session", at("session").string(), "--json"});
    ASSERT_EQ(scanned.status, 1) << scanned.err;  // one side only: not conclusive
  }
  static void SetUpTestSuite() {
    scan_session();
    whole_ = test::run_command({"export", at("session").string(), "--to", at("bag").string(), "--json",
                                "--base-url", "https://example.org/t"});
  }
  static void TearDownTestSuite() { delete folder_; }
  [[nodiscard]] static std::filesystem::path at(const std::string& name) { return folder_->path() / name; }
  [[nodiscard]] static std::filesystem::path data(const std::string& name) {
    return at("bag") / "data" / name;
  }
  [[nodiscard]] static test::Outcome export_to(const std::string& name,
                                               const std::vector<std::string>& more) {
    std::vector<std::string> words{"export", at("session").string(), "--to", at(name).string(), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return test::run_command(words);
  }

  inline static test::TemporaryFolder* folder_ = nullptr;
  inline static test::Outcome whole_;
};

/// A copy of the session for each test, to be changed or harmed. Nobody needs the package of the suite.
class ExportOfACopy : public Export {
 protected:
  static void SetUpTestSuite() { scan_session(); }
  void SetUp() override {
    session_ = at(std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::copy(at("session"), session_, std::filesystem::copy_options::recursive);
  }
  [[nodiscard]] std::filesystem::path bag() const { return session_.string() + ".bag"; }
  [[nodiscard]] test::Outcome pack_without(const std::string& parts,
                                           const std::vector<std::string>& more) const {
    std::vector<std::string> words{"export", session_.string(), "--to", bag().string(),
                                   "--json", "--without",       parts};
    words.insert(words.end(), more.begin(), more.end());
    return test::run_command(words);
  }
  [[nodiscard]] std::string packed(const std::string& file) const {
    return test::bytes_of(bag() / "data" / file);
  }
  /// With what was broken into lines put together again.
  [[nodiscard]] std::string readme() const {
    std::string out;
    for (const char c : packed("README.txt")) {
      if (c != '\n' && c != ' ') {
        out += c;
      } else if (!out.ends_with(' ')) {
        out += ' ';
      }
    }
    return out;
  }

  std::filesystem::path session_;
};

}  // namespace dubsar
