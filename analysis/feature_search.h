// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace dubsar {

struct FeatureMatch {
  std::size_t index = 0;  ///< of the added vector
  double distance = 0;
};

enum class FeatureDistance { kL1, kL2 };

/// Nearest neighbours of feature vectors: an exact kd-tree (FLANN, single tree), so that the same collection
/// gives the same answer every time.
class FeatureSearch {
 public:
  /// rows: all of one length, finite.
  FeatureSearch(const std::vector<std::vector<float>>& rows, FeatureDistance distance);
  ~FeatureSearch();
  FeatureSearch(FeatureSearch&&) noexcept;
  FeatureSearch& operator=(FeatureSearch&&) noexcept;
  FeatureSearch(const FeatureSearch&) = delete;
  FeatureSearch& operator=(const FeatureSearch&) = delete;

  /// The nearest `count` rows, nearest first, equals by index; fewer where there are no more. `query` has the
  /// length of a row.
  [[nodiscard]] std::vector<FeatureMatch> nearest(const std::vector<float>& query, std::size_t count) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dubsar
