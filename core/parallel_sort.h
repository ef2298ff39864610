// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/thread_sanitizer.h"

#ifdef DUBSAR_THREAD_SANITIZER
#include <algorithm>
#else
#include <tbb/parallel_sort.h>
#endif

namespace dubsar {

/// Sorts by an order in which only equal values are equal: it is not stable.
template <class Iterator, class Less>
void parallel_sort(Iterator begin, Iterator end, const Less& less) {
#ifdef DUBSAR_THREAD_SANITIZER
  std::sort(begin, end, less);
#else
  tbb::parallel_sort(begin, end, less);
#endif
}

}  // namespace dubsar
