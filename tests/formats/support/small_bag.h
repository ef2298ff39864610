// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "formats/bag_check.h"
#include "formats/sha2.h"
#include "tests/support/temporary_folder.h"

namespace dubsar::test {

/// A small bag, written out by hand as RFC 8493 has it.
class SmallBag : public testing::Test {
 protected:
  void SetUp() override {
    put("data/master.ply", "ply and so on\n");
    put("data/rückseite 100%.png", "a picture");  // its % is encoded in the manifests
    put("bagit.txt", "BagIt-Version: 1.0\nTag-File-Character-Encoding: UTF-8\n");
    put("bag-info.txt", "Source-Organization: A museum\n  with a long\n  name\nPayload-Oxum: 23.2\n");
    list_all();
  }
  void put(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((bag() / name).parent_path());
    std::ofstream(bag() / name, std::ios::binary) << text;
  }
  static std::string line(const std::string& name, const std::string& sum) {
    return sum + "  " + name + "\n";
  }
  std::string sum512(const std::string& name) const { return sha512_of_file(bag() / name, job_).value(); }
  void list_all() const {
    put("manifest-sha512.txt", line("data/master.ply", sum512("data/master.ply")) +
                                   line("data/rückseite 100%25.png", sum512("data/rückseite 100%.png")));
    put("manifest-sha256.txt", line("data/master.ply", sha256_hex("ply and so on\n")) +
                                   line("data/rückseite 100%25.png", sha256_hex("a picture")));
    std::string tags;
    for (const char* name : {"bagit.txt", "bag-info.txt", "manifest-sha512.txt", "manifest-sha256.txt"}) {
      tags += line(name, sum512(name));
    }
    put("tagmanifest-sha512.txt", tags);
  }
  BagReport check() {
    const Result<BagReport> report = check_bag(bag(), job_);
    EXPECT_TRUE(report) << report.error().line();
    return report.value_or(BagReport{});
  }
  /// "where: what" of the damage.
  std::vector<std::string> faults() {
    std::vector<std::string> out;
    for (const Error& error : check().damaged) {
      out.push_back(error.where + ": " + error.what);
    }
    return out;
  }
  std::filesystem::path bag() const { return temporary_.path() / "bag"; }

  TemporaryFolder temporary_;
  JobContext job_;
};

}  // namespace dubsar::test
