// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/digest.h"

#include <gtest/gtest.h>

#include <fstream>

#include "formats/sha2.h"
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

TEST(Sha512, ExamplesOfTheStandard) {
  EXPECT_EQ(sha512_hex(""),
            "cf83e1357eefb8bdf1542850d66d8007d620e4050b5715dc83f4a921d36ce9ce47d0d13c5d85f2b0ff8318d2877eec2f"
            "63b931bd47417a81a538327af927da3e");
  EXPECT_EQ(sha512_hex("abc"),
            "ddaf35a193617abacc417349ae20413112e6fa4e89a97ea20a9eeee64b55d39a2192992a274fc1a836ba3c23a3feebbd"
            "454d4423643ce80e2a9ac94fa54ca49f");
  EXPECT_EQ(sha512_hex("abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmnhijklmnoijklmnopjklmnopqklmno"
                       "pqrlmnopqrsmnopqrstnopqrstu"),
            "8e959b75dae313da8cf4f72814fc143f8f7779c6eb9f7fa17299aeadb6889018501d289e4900f7e4331b99dec4b5433a"
            "c7d329eeb6dd26545e96e55b874be909");
  EXPECT_EQ(sha512_hex(std::string(1000000, 'a')),
            "e718483d0ce769644e2e42c7bc15b4638e1f98b13b2044285632a803afa973ebde0ff244877ea60a4cb0432ce577c31b"
            "eb009c5c2c49aa2e4eadb217ad8cc09b");
}

// RFC 1321, A.5, and FIPS 180-4's examples.
TEST(Digest, WhatTheManifestsOfOthersGoBy) {
  const auto of_abc = [](const char* name) {
    const auto digest = digest_named(name);
    return digest ? digest_hex(*digest, "abc") : "not done by this system";
  };
  EXPECT_EQ(of_abc("md5"), "900150983cd24fb0d6963f7d28e17f72");
  EXPECT_EQ(of_abc("sha1"), "a9993e364706816aba3e25717850c26c9cd0d89d");
  EXPECT_EQ(of_abc("sha224"), "23097d223405d8228642a477bda255b32aadbce4bda0b3f7e36c9da7");
  EXPECT_EQ(
      of_abc("sha384"),
      "cb00753f45a35e8bb5a03d699ac65007272c32ab0eded1631a8b605a43ff5bed8086072ba1e7cc2358baeca134c825a7");
  EXPECT_EQ(of_abc("sha256"), sha256_hex("abc"));
  EXPECT_FALSE(digest_named("crc32"));
}

TEST(Sha2, PiecesOfAnyLengthGiveTheSame) {
  std::string text;
  for (int i = 0; i < 400; ++i) {
    text.push_back(static_cast<char>(i * 37));
  }
  const std::string whole = sha512_hex(text);
  for (std::size_t cut = 0; cut <= text.size(); ++cut) {
    DigestSum sum(Digest::kSha512);
    sum.add(std::string_view(text).substr(0, cut));
    sum.add(std::string_view(text).substr(cut));
    EXPECT_EQ(sum.hex(), whole) << cut;
  }
}

TEST(Sha2, OfAFile) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "file";
  std::ofstream(path, std::ios::binary) << "abc";
  EXPECT_EQ(sha512_of_file(path, JobContext()).value_or(""), sha512_hex("abc"));
  EXPECT_EQ(sha256_of_file(path, JobContext()).value_or(""), sha256_hex("abc"));
  EXPECT_EQ(sha512_of_file(folder.path() / "none", JobContext()).error().kind, ErrorKind::kBadInput);
  EXPECT_EQ(sha512_of_file("/dev/zero", JobContext()).error().what, "not a file");
  JobContext stopped;
  stopped.cancel();
  EXPECT_EQ(sha512_of_file(path, stopped).error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace dubsar
