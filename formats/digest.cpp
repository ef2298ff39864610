// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/digest.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <new>
#include <utility>
#include <vector>

#include "formats/atomic_file.h"

namespace dubsar {

namespace {

constexpr std::size_t kPieceBytes = std::size_t{1} << 20U;

using Known = std::pair<std::string_view, Digest>;
constexpr std::array<Known, 6> kKnown = {{{"md5", Digest::kMd5},
                                          {"sha1", Digest::kSha1},
                                          {"sha224", Digest::kSha224},
                                          {"sha256", Digest::kSha256},
                                          {"sha384", Digest::kSha384},
                                          {"sha512", Digest::kSha512}}};

const EVP_MD* method_of(Digest kind) {
  switch (kind) {
    case Digest::kMd5:
      return EVP_md5();
    case Digest::kSha1:
      return EVP_sha1();
    case Digest::kSha224:
      return EVP_sha224();
    case Digest::kSha256:
      return EVP_sha256();
    case Digest::kSha384:
      return EVP_sha384();
    case Digest::kSha512:
      break;
  }
  return EVP_sha512();
}

/// libcrypto says no only where memory has run out, or of what digest_named() does not name.
void must(int done) {
  if (done != 1) {
    throw std::bad_alloc();
  }
}

}  // namespace

std::optional<Digest> digest_named(std::string_view name) {
  const auto* const known = std::ranges::find(kKnown, name, &Known::first);
  if (known == kKnown.end()) {
    return std::nullopt;
  }
  // A system that is held to stricter rules does without MD5 and SHA-1.
  EVP_MD* const there = EVP_MD_fetch(nullptr, std::string(name).c_str(), nullptr);
  EVP_MD_free(there);
  return there != nullptr ? std::optional(known->second) : std::nullopt;
}

void DigestSum::Free::operator()(void* context) const {
  EVP_MD_CTX_free(static_cast<EVP_MD_CTX*>(context));
}

DigestSum::DigestSum(Digest kind) : context_(EVP_MD_CTX_new()) {
  must(context_ != nullptr ? 1 : 0);
  must(EVP_DigestInit_ex(static_cast<EVP_MD_CTX*>(context_.get()), method_of(kind), nullptr));
}

void DigestSum::add(std::string_view bytes) {
  must(EVP_DigestUpdate(static_cast<EVP_MD_CTX*>(context_.get()), bytes.data(), bytes.size()));
}

std::string DigestSum::hex() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> sum{};
  unsigned int length = 0;
  must(EVP_DigestFinal_ex(static_cast<EVP_MD_CTX*>(context_.get()), sum.data(), &length));
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string out;
  for (unsigned int i = 0; i < length; ++i) {
    out.push_back(kDigits[sum[i] >> 4U]);
    out.push_back(kDigits[sum[i] & 0xfU]);
  }
  return out;
}

std::string digest_hex(Digest kind, std::string_view bytes) {
  DigestSum sum(kind);
  sum.add(bytes);
  return sum.hex();
}

Result<std::string> digest_of_file(Digest kind, const std::filesystem::path& path, const JobContext& job) {
  Result<std::ifstream> file = open_stored_file(path);
  if (!file) {
    return std::unexpected(file.error());
  }
  std::vector<char> piece(kPieceBytes);
  DigestSum sum(kind);
  while (*file) {
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "stopped", path.string());
    }
    file->read(piece.data(), static_cast<std::streamsize>(piece.size()));
    sum.add({piece.data(), static_cast<std::size_t>(file->gcount())});
  }
  if (file->bad()) {
    return fail(ErrorKind::kStorage, "cannot be read to its end", path.string(), "check the disk");
  }
  return sum.hex();
}

}  // namespace dubsar
