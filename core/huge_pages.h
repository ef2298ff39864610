// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <vector>

namespace dubsar {

/// Asks the kernel to back memory that was not touched yet by huge pages, where it has them to give (Linux,
/// transparent huge pages). A wish: nothing fails. Of use where arrays of megabytes are written once, front
/// to back, and much of the time would go to taking page after page.
void wish_for_huge_pages(void* memory, std::size_t bytes);

/// Takes the pages of memory that was not touched yet from the system, by all cores at once: it is the
/// clearing of them that takes long. What it held is not kept.
void touch_in_parallel(void* memory, std::size_t bytes);

/// resize() of an empty array, in huge pages where there are any.
template <class T>
void resize_in_huge_pages(std::vector<T>& array, std::size_t size) {
  array.reserve(size);
  wish_for_huge_pages(array.data(), size * sizeof(T));
  touch_in_parallel(array.data(), size * sizeof(T));
  array.resize(size);
}

}  // namespace dubsar
