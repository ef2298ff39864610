// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/sha512.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>
#include <vector>

namespace dubsar {

namespace {

/// FIPS 180-4, 4.2.3: the first 64 bits of the fractional parts of the cube roots of the first 80 primes.
constexpr std::array<std::uint64_t, 80> kRound = {
    0x428a2f98d728ae22U, 0x7137449123ef65cdU, 0xb5c0fbcfec4d3b2fU, 0xe9b5dba58189dbbcU, 0x3956c25bf348b538U,
    0x59f111f1b605d019U, 0x923f82a4af194f9bU, 0xab1c5ed5da6d8118U, 0xd807aa98a3030242U, 0x12835b0145706fbeU,
    0x243185be4ee4b28cU, 0x550c7dc3d5ffb4e2U, 0x72be5d74f27b896fU, 0x80deb1fe3b1696b1U, 0x9bdc06a725c71235U,
    0xc19bf174cf692694U, 0xe49b69c19ef14ad2U, 0xefbe4786384f25e3U, 0x0fc19dc68b8cd5b5U, 0x240ca1cc77ac9c65U,
    0x2de92c6f592b0275U, 0x4a7484aa6ea6e483U, 0x5cb0a9dcbd41fbd4U, 0x76f988da831153b5U, 0x983e5152ee66dfabU,
    0xa831c66d2db43210U, 0xb00327c898fb213fU, 0xbf597fc7beef0ee4U, 0xc6e00bf33da88fc2U, 0xd5a79147930aa725U,
    0x06ca6351e003826fU, 0x142929670a0e6e70U, 0x27b70a8546d22ffcU, 0x2e1b21385c26c926U, 0x4d2c6dfc5ac42aedU,
    0x53380d139d95b3dfU, 0x650a73548baf63deU, 0x766a0abb3c77b2a8U, 0x81c2c92e47edaee6U, 0x92722c851482353bU,
    0xa2bfe8a14cf10364U, 0xa81a664bbc423001U, 0xc24b8b70d0f89791U, 0xc76c51a30654be30U, 0xd192e819d6ef5218U,
    0xd69906245565a910U, 0xf40e35855771202aU, 0x106aa07032bbd1b8U, 0x19a4c116b8d2d0c8U, 0x1e376c085141ab53U,
    0x2748774cdf8eeb99U, 0x34b0bcb5e19b48a8U, 0x391c0cb3c5c95a63U, 0x4ed8aa4ae3418acbU, 0x5b9cca4f7763e373U,
    0x682e6ff3d6b2b8a3U, 0x748f82ee5defb2fcU, 0x78a5636f43172f60U, 0x84c87814a1f0ab72U, 0x8cc702081a6439ecU,
    0x90befffa23631e28U, 0xa4506cebde82bde9U, 0xbef9a3f7b2c67915U, 0xc67178f2e372532bU, 0xca273eceea26619cU,
    0xd186b8c721c0c207U, 0xeada7dd6cde0eb1eU, 0xf57d4f7fee6ed178U, 0x06f067aa72176fbaU, 0x0a637dc5a2c898a6U,
    0x113f9804bef90daeU, 0x1b710b35131c471bU, 0x28db77f523047d84U, 0x32caab7b40c72493U, 0x3c9ebe0a15c9bebcU,
    0x431d67c49c100d4cU, 0x4cc5d4becb3e42b6U, 0x597f299cfc657e2aU, 0x5fcb6fab3ad6faecU, 0x6c44198c4a475817U};

constexpr std::size_t kPieceBytes = std::size_t{1} << 20U;

}  // namespace

void Sha512::block(const std::uint8_t* bytes) {
  std::array<std::uint64_t, 80> w{};
  for (std::size_t t = 0; t < 16; ++t) {
    for (std::size_t k = 0; k < 8; ++k) {
      w[t] = w[t] << 8U | bytes[8 * t + k];
    }
  }
  for (std::size_t t = 16; t < 80; ++t) {
    const std::uint64_t s0 = std::rotr(w[t - 15], 1) ^ std::rotr(w[t - 15], 8) ^ (w[t - 15] >> 7U);
    const std::uint64_t s1 = std::rotr(w[t - 2], 19) ^ std::rotr(w[t - 2], 61) ^ (w[t - 2] >> 6U);
    w[t] = w[t - 16] + s0 + w[t - 7] + s1;
  }
  auto [a, b, c, d, e, f, g, h] = state_;
  for (std::size_t t = 0; t < 80; ++t) {
    const std::uint64_t big1 = std::rotr(e, 14) ^ std::rotr(e, 18) ^ std::rotr(e, 41);
    const std::uint64_t t1 = h + big1 + ((e & f) ^ (~e & g)) + kRound[t] + w[t];
    const std::uint64_t big0 = std::rotr(a, 28) ^ std::rotr(a, 34) ^ std::rotr(a, 39);
    const std::uint64_t t2 = big0 + ((a & b) ^ (a & c) ^ (b & c));
    h = g;
    g = f;
    f = e;
    e = d + t1;
    d = c;
    c = b;
    b = a;
    a = t1 + t2;
  }
  const std::array<std::uint64_t, 8> add{a, b, c, d, e, f, g, h};
  for (std::size_t k = 0; k < 8; ++k) {
    state_[k] += add[k];
  }
}

void Sha512::add(std::string_view bytes) {
  total_bytes_ += bytes.size();
  const auto* at = reinterpret_cast<const std::uint8_t*>(bytes.data());
  std::size_t left = bytes.size();
  if (waiting_count_ > 0) {
    const std::size_t take = std::min(left, waiting_.size() - waiting_count_);
    std::memcpy(waiting_.data() + waiting_count_, at, take);
    waiting_count_ += take;
    at += take;
    left -= take;
    if (waiting_count_ < waiting_.size()) {
      return;
    }
    block(waiting_.data());
    waiting_count_ = 0;
  }
  for (; left >= waiting_.size(); at += waiting_.size(), left -= waiting_.size()) {
    block(at);
  }
  if (left > 0) {
    std::memcpy(waiting_.data(), at, left);
    waiting_count_ = left;
  }
}

std::string Sha512::hex() {
  // The length is a 128-bit number of bits; more than 2^61 bytes are not to be had.
  const std::uint64_t bits = 8 * total_bytes_;
  std::string tail(1, '\x80');
  tail.append((239 - waiting_count_) % 128 + 8, '\0');
  for (unsigned shift = 64; shift > 0; shift -= 8) {
    tail.push_back(static_cast<char>((bits >> (shift - 8)) & 0xffU));
  }
  add(tail);
  std::string out;
  for (const std::uint64_t word : state_) {
    for (unsigned shift = 64; shift > 0; shift -= 4) {
      out.push_back("0123456789abcdef"[(word >> (shift - 4)) & 0xfU]);
    }
  }
  return out;
}

std::string sha512_hex(std::string_view bytes) {
  Sha512 sum;
  sum.add(bytes);
  return sum.hex();
}

Result<std::string> sha512_of_file(const std::filesystem::path& path, const JobContext& job) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return bad_input(path.string(), "missing or unreadable", "bring it back from a copy");
  }
  std::vector<char> piece(kPieceBytes);
  Sha512 sum;
  while (file) {
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "stopped", path.string());
    }
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    sum.add({piece.data(), static_cast<std::size_t>(file.gcount())});
  }
  if (file.bad()) {
    return fail(ErrorKind::kStorage, "cannot be read to its end", path.string(), "check the disk");
  }
  return sum.hex();
}

}  // namespace dubsar
