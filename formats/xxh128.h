// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace dubsar {

/// XXH3, 128 bits, piece by piece: against damage, not against anybody.
class Xxh128 {
 public:
  Xxh128();
  ~Xxh128();
  Xxh128(const Xxh128&) = delete;
  Xxh128& operator=(const Xxh128&) = delete;

  void add(const void* bytes, std::size_t count);
  /// Of all that was added: canonical, 32 lower-case hexadecimal digits.
  [[nodiscard]] std::string hex() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

[[nodiscard]] std::string xxh128_hex(std::string_view bytes);

}  // namespace dubsar
