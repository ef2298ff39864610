// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/feature_search.h"

#include <algorithm>
#include <cmath>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wnon-virtual-dtor"
#pragma GCC diagnostic ignored "-Woverloaded-virtual"
#pragma GCC diagnostic ignored "-Wcast-qual"
#include <flann/flann.hpp>
#pragma GCC diagnostic pop

namespace dubsar {

struct FeatureSearch::Impl {
  using L1 = flann::KDTreeSingleIndex<flann::L1<float>>;
  using L2 = flann::KDTreeSingleIndex<flann::L2<float>>;
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<float> values;
  std::unique_ptr<L1> l1;
  std::unique_ptr<L2> l2;
};

FeatureSearch::FeatureSearch(const std::vector<std::vector<float>>& rows, FeatureDistance distance)
    : impl_(std::make_unique<Impl>()) {
  impl_->rows = rows.size();
  impl_->columns = rows.empty() ? 0 : rows.front().size();
  for (const std::vector<float>& row : rows) {
    impl_->values.insert(impl_->values.end(), row.begin(), row.end());
  }
  if (rows.empty() || impl_->columns == 0) {
    return;
  }
  const flann::Matrix<float> matrix(impl_->values.data(), impl_->rows, impl_->columns);
  const flann::KDTreeSingleIndexParams params(10, false);
  if (distance == FeatureDistance::kL1) {
    impl_->l1 = std::make_unique<Impl::L1>(matrix, params);
    impl_->l1->buildIndex();
  } else {
    impl_->l2 = std::make_unique<Impl::L2>(matrix, params);
    impl_->l2->buildIndex();
  }
}

FeatureSearch::~FeatureSearch() = default;
FeatureSearch::FeatureSearch(FeatureSearch&&) noexcept = default;
FeatureSearch& FeatureSearch::operator=(FeatureSearch&&) noexcept = default;

std::vector<FeatureMatch> FeatureSearch::nearest(const std::vector<float>& query, std::size_t count) const {
  count = std::min(count, impl_->rows);
  if (count == 0 || query.size() != impl_->columns) {
    return {};
  }
  std::vector<float> asked = query;
  std::vector<std::vector<std::size_t>> indices;
  std::vector<std::vector<float>> distances;
  const flann::Matrix<float> matrix(asked.data(), 1, asked.size());
  const flann::SearchParams params(flann::FLANN_CHECKS_UNLIMITED, 0.0F, true);
  if (impl_->l1) {
    impl_->l1->knnSearch(matrix, indices, distances, count, params);
  } else {
    impl_->l2->knnSearch(matrix, indices, distances, count, params);
  }
  std::vector<FeatureMatch> matches;
  for (std::size_t i = 0; i < indices.front().size(); ++i) {
    const double d = distances.front()[i];
    matches.push_back({indices.front()[i], impl_->l1 ? d : std::sqrt(d)});
  }
  std::ranges::sort(matches, [](const FeatureMatch& a, const FeatureMatch& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.index < b.index;
  });
  return matches;
}

}  // namespace dubsar
