// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/parallel.h"

namespace dubsar {

/// std::erase_if() where asking is the work: gone(item) is asked on all cores, what stays moves up after.
template <class T, class Gone>
void erase_where(std::vector<T>& items, const Gone& gone) {
  std::vector<std::uint8_t> goes(items.size());
  parallel_for_each_index(
      items.size(), [&](std::size_t i) { goes[i] = gone(items[i]) ? 1 : 0; }, 16384);
  std::size_t out = static_cast<std::size_t>(std::ranges::find(goes, 1) - goes.begin());
  for (std::size_t i = out; i < items.size(); ++i) {
    if (goes[i] == 0) {
      items[out++] = items[i];
    }
  }
  items.resize(out);
}

}  // namespace dubsar
