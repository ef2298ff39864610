// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/sha2.h"

#include <openssl/evp.h>

#include <array>
#include <cstddef>
#include <new>
#include <vector>

#include "formats/atomic_file.h"

namespace dubsar {

namespace {

constexpr std::size_t kPieceBytes = std::size_t{1} << 20U;

/// libcrypto says no only where memory has run out or it was built without SHA-2.
void must(int done) {
  if (done != 1) {
    throw std::bad_alloc();
  }
}

}  // namespace

void Sha2Sum::Free::operator()(void* context) const {
  EVP_MD_CTX_free(static_cast<EVP_MD_CTX*>(context));
}

Sha2Sum::Sha2Sum(Sha2 kind) : context_(EVP_MD_CTX_new()) {
  must(context_ != nullptr ? 1 : 0);
  must(EVP_DigestInit_ex(static_cast<EVP_MD_CTX*>(context_.get()),
                         kind == Sha2::k256 ? EVP_sha256() : EVP_sha512(), nullptr));
}

void Sha2Sum::add(std::string_view bytes) {
  must(EVP_DigestUpdate(static_cast<EVP_MD_CTX*>(context_.get()), bytes.data(), bytes.size()));
}

std::string Sha2Sum::hex() {
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

std::string sha2_hex(Sha2 kind, std::string_view bytes) {
  Sha2Sum sum(kind);
  sum.add(bytes);
  return sum.hex();
}

Result<std::string> sha2_of_file(Sha2 kind, const std::filesystem::path& path, const JobContext& job) {
  Result<std::ifstream> file = open_stored_file(path);
  if (!file) {
    return std::unexpected(file.error());
  }
  std::vector<char> piece(kPieceBytes);
  Sha2Sum sum(kind);
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
