// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>

namespace dubsar {

/// An array whose elements hold nothing until they are written: tens of megabytes are neither cleared first
/// nor faulted in page by page (a large one lies on huge pages where the system has them).
template <class T>
class BigArray {
 public:
  static_assert(std::is_trivially_destructible_v<T> && std::is_trivially_copyable_v<T>);

  BigArray() = default;
  explicit BigArray(std::size_t count) {
    const std::size_t bytes = (count * sizeof(T) + kPage - 1) / kPage * kPage;
    const bool large = bytes >= 2 * kPage;
    void* const memory = count == 0 ? nullptr
                         : large    ? std::aligned_alloc(kPage, bytes)
                                    : std::malloc(count * sizeof(T));
    if (memory == nullptr && count > 0) {
      throw std::bad_alloc();
    }
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    if (large) {
      ::madvise(memory, bytes, MADV_HUGEPAGE);  // a wish; refused is as good
    }
#endif
    values_.reset(static_cast<T*>(memory));
  }

  [[nodiscard]] T& operator[](std::size_t i) {
    return values_.get()[i];
  }
  [[nodiscard]] const T& operator[](std::size_t i) const {
    return values_.get()[i];
  }

 private:
  static constexpr std::size_t kPage = std::size_t{1} << 21;
  struct Free {
    void operator()(T* values) const { std::free(values); }
  };
  std::unique_ptr<T, Free> values_;
};

}  // namespace dubsar
