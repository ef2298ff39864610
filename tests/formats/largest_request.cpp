// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "tests/formats/largest_request.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> largest_request{0};

void* take(std::size_t size) {
  for (std::size_t before = largest_request.load(); size > before;) {
    if (largest_request.compare_exchange_weak(before, size)) {
      break;
    }
  }
  return std::malloc(size == 0 ? 1 : size);
}

}  // namespace

void* operator new(std::size_t size) {
  void* out = take(size);
  if (out == nullptr) {
    throw std::bad_alloc();
  }
  return out;
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return take(size);
}
void operator delete(void* at) noexcept {
  std::free(at);
}
void operator delete(void* at, std::size_t) noexcept {
  std::free(at);
}

namespace dubsar::test {

std::size_t largest_request_bytes() {
  return largest_request.load();
}
void forget_largest_request() {
  largest_request = 0;
}

}  // namespace dubsar::test
