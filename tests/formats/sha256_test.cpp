// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/sha256.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

// FIPS 180-4's own examples (NIST, "SHA256.pdf" of the example values).
TEST(Sha256, ExamplesOfTheStandard) {
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256_hex(std::string(1000000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, PiecesOfAnyLengthGiveTheSame) {
  std::string text;
  for (int i = 0; i < 300; ++i) {
    text.push_back(static_cast<char>(i * 37));
  }
  const std::string whole = sha256_hex(text);
  for (std::size_t cut = 0; cut <= text.size(); ++cut) {
    Sha256 sum;
    sum.add(std::string_view(text).substr(0, cut));
    sum.add(std::string_view(text).substr(cut));
    EXPECT_EQ(sum.hex(), whole) << cut;
  }
}

TEST(Sha256, OfAFile) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "file";
  std::ofstream(path, std::ios::binary) << "abc";
  EXPECT_EQ(sha256_of_file(path, JobContext()).value_or(""), sha256_hex("abc"));
  EXPECT_EQ(sha256_of_file(folder.path() / "none", JobContext()).error().kind, ErrorKind::kBadInput);
  JobContext stopped;
  stopped.cancel();
  EXPECT_EQ(sha256_of_file(path, stopped).error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace dubsar
