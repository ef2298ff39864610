// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/feature_search.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

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

  /// Without a tree as yet.
  Impl(const std::vector<std::vector<float>>& from, FeatureDistance distance)
      : rows(from.size()), columns(from.empty() ? 0 : from.front().size()) {
    values.reserve(rows * columns);
    for (const std::vector<float>& row : from) {
      values.insert(values.end(), row.begin(), row.end());
    }
    if (rows == 0 || columns == 0) {
      return;
    }
    const flann::Matrix<float> matrix(values.data(), rows, columns);
    const flann::KDTreeSingleIndexParams params(10, false);
    if (distance == FeatureDistance::kL1) {
      l1 = std::make_unique<L1>(matrix, params);
    } else {
      l2 = std::make_unique<L2>(matrix, params);
    }
  }
};

FeatureSearch::FeatureSearch(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

FeatureSearch::FeatureSearch(const std::vector<std::vector<float>>& rows, FeatureDistance distance)
    : impl_(std::make_unique<Impl>(rows, distance)) {
  if (impl_->l1) {
    impl_->l1->buildIndex();
  } else if (impl_->l2) {
    impl_->l2->buildIndex();
  }
}

std::string FeatureSearch::tree() const {
  char* bytes = nullptr;
  std::size_t size = 0;
  std::FILE* stream = impl_->l1 || impl_->l2 ? open_memstream(&bytes, &size) : nullptr;
  if (stream == nullptr) {
    return {};
  }
  bool whole = true;
  try {
    if (impl_->l1) {
      impl_->l1->saveIndex(stream);
    } else {
      impl_->l2->saveIndex(stream);
    }
  } catch (const flann::FLANNException&) {
    whole = false;  // no memory: the tree is built again next time
  }
  whole = std::fclose(stream) == 0 && whole;
  const std::unique_ptr<char, decltype(&std::free)> owned(bytes, &std::free);
  return whole ? std::string(bytes, size) : std::string();
}

std::optional<FeatureSearch> FeatureSearch::with_tree(const std::vector<std::vector<float>>& rows,
                                                      FeatureDistance distance, std::string_view tree) {
  auto impl = std::make_unique<Impl>(rows, distance);
  if (!impl->l1 && !impl->l2) {
    return FeatureSearch(std::move(impl));
  }
  std::string bytes(tree);  // fmemopen() wants memory that it could write to
  std::FILE* stream = bytes.empty() ? nullptr : fmemopen(bytes.data(), bytes.size(), "rb");
  if (stream == nullptr) {
    return std::nullopt;
  }
  bool fits = false;
  try {
    const auto load = [&](auto& index) {
      index.loadIndex(stream);
      return index.size() == impl->rows && index.veclen() == impl->columns;
    };
    fits = impl->l1 ? load(*impl->l1) : load(*impl->l2);
  } catch (const flann::FLANNException&) {
    fits = false;
  }
  std::fclose(stream);
  return fits ? std::optional(FeatureSearch(std::move(impl))) : std::nullopt;
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
