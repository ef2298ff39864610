// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
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

  /// The tree without the rows, for with_tree(); empty of no rows.
  [[nodiscard]] std::string tree() const;
  /// The same search without building the tree again: twenty times as fast for a million rows. `tree` is what
  /// tree() gave of the very same rows. FLANN trusts these bytes: never hand it any that somebody else can
  /// have written. Nothing where it notices that they are of other rows or of another version of it.
  [[nodiscard]] static std::optional<FeatureSearch> with_tree(const std::vector<std::vector<float>>& rows,
                                                              FeatureDistance distance,
                                                              std::string_view tree);

  /// The nearest `count` rows, nearest first, equals by index; fewer where there are no more. `query` has the
  /// length of a row.
  [[nodiscard]] std::vector<FeatureMatch> nearest(const std::vector<float>& query, std::size_t count) const;

 private:
  struct Impl;
  explicit FeatureSearch(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace dubsar
