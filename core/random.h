// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

#include "core/units.h"

namespace dubsar {

/// A small seeded generator (SplitMix64, Steele et al. 2014). The standard distributions may differ between
/// library versions; these draws are the same bytes everywhere, as long as no two of them are operands of one
/// operator or arguments of one call, between which C++ leaves the order to the compiler. Never a global:
/// pass it, or seed one per item.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    state_ += 0x9e3779b97f4a7c15ULL;
    std::uint64_t v = state_;
    v = (v ^ (v >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    v = (v ^ (v >> 27U)) * 0x94d049bb133111ebULL;
    return v ^ (v >> 31U);
  }
  /// In [0, 1).
  double uniform() { return static_cast<double>(next() >> 11U) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In [0, count).
  std::uint64_t below(std::uint64_t count) { return count == 0 ? 0 : next() % count; }
  /// Standard normal (Box-Muller; one of the pair is thrown away so that the state stays one word).
  double normal() {
    const double u = 1.0 - uniform();
    const double v = uniform();
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * kPi * v);
  }
  /// Of independent standard normals; the last coordinate is drawn first.
  Eigen::Vector3d normal3() {
    const double z = normal();
    const double y = normal();
    const double x = normal();
    return {x, y, z};
  }

 private:
  std::uint64_t state_;
};

/// A seed for item `index` of a stream `seed`: independent of the order in which items are worked on.
[[nodiscard]] inline std::uint64_t seed_for(std::uint64_t seed, std::uint64_t index) {
  return Random(seed ^ (index * 0xd1342543de82ef95ULL + 0x2545f4914f6cdd1dULL)).next();
}

}  // namespace dubsar
