// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

/// Vectors for functions that work on several samples at once (wide_clones.h): three plain floats, and
/// nothing that branches or calls, so that the compiler can put each part into a register of its own.
namespace dubsar::wide {

struct Vec {
  float x, y, z;
};

[[gnu::always_inline]] inline Vec step(const Vec& from, const Vec& to) {
  return {to.x - from.x, to.y - from.y, to.z - from.z};
}
[[gnu::always_inline]] inline float dot(const Vec& a, const Vec& b) {
  return a.x * b.x + (a.y * b.y + a.z * b.z);
}
[[gnu::always_inline]] inline Vec cross(const Vec& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[gnu::always_inline]] inline float larger(float a, float b) {
  return a < b ? b : a;
}

}  // namespace dubsar::wide
