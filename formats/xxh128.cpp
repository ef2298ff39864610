// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/xxh128.h"

#include <xxhash.h>

namespace dubsar {

struct Xxh128::State {
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> xxh{XXH3_createState(), &XXH3_freeState};
};

Xxh128::Xxh128() : state_(std::make_unique<State>()) {
  XXH3_128bits_reset(state_->xxh.get());
}
Xxh128::~Xxh128() = default;

void Xxh128::add(const void* bytes, std::size_t count) {
  if (count > 0) {
    XXH3_128bits_update(state_->xxh.get(), bytes, count);
  }
}

std::string Xxh128::hex() const {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state_->xxh.get()));
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string out;
  for (const unsigned char byte : canonical.digest) {
    out += kDigits[byte >> 4U];
    out += kDigits[byte & 15U];
  }
  return out;
}

std::string xxh128_hex(std::string_view bytes) {
  Xxh128 sum;
  sum.add(bytes.data(), bytes.size());
  return sum.hex();
}

}  // namespace dubsar
