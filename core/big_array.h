// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include <cstddef>
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
    const std::size_t bytes = count * sizeof(T);
    const bool large = bytes > kPage;
    const std::align_val_t alignment{large ? kPage : alignof(std::max_align_t)};
    void* const memory = ::operator new(bytes, alignment);
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    if (large) {
      ::madvise(memory, bytes, MADV_HUGEPAGE);  // a wish; refused is as good
    }
#endif
    values_ = std::unique_ptr<T, Free>(static_cast<T*>(memory), {alignment});
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
    std::align_val_t alignment{};
    void operator()(T* values) const { ::operator delete(values, alignment); }
  };
  std::unique_ptr<T, Free> values_;
};

}  // namespace dubsar
