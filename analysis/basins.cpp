// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/basins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/parallel_sort.h"

namespace dubsar {

namespace {

constexpr std::int32_t kUnvisited = -3;

/// The flood: basins under construction, joined by union-find.
class Flood {
 public:
  Flood(const VertexGraph& graph, std::span<const float> height_mm, const BasinOptions& options,
        std::vector<std::int32_t>* label)
      : graph_(graph), height_(height_mm), options_(options), label_(*label) {}

  void visit(std::uint32_t v) {
    around_.clear();
    for (const std::uint32_t n : ring(v)) {
      note(label_[n]);
    }
    if (around_.size() > 1) {
      meet(v);
    } else if (around_.size() == 1) {
      add(v, around_.front());
    } else if (const std::int32_t near = options_.classical ? -1 : biggest_in_second_ring(v); near >= 0) {
      add(v, near);
    } else {
      parent_.push_back(static_cast<std::int32_t>(parent_.size()));
      size_.push_back(0);
      lowest_.push_back(v);
      add(v, parent_.back());
    }
  }

  [[nodiscard]] std::int32_t root(std::int32_t basin) {
    while (parent_[static_cast<std::size_t>(basin)] != basin) {
      std::int32_t& up = parent_[static_cast<std::size_t>(basin)];
      up = parent_[static_cast<std::size_t>(up)];
      basin = up;
    }
    return basin;
  }
  [[nodiscard]] std::size_t count() const { return parent_.size(); }
  [[nodiscard]] std::uint32_t lowest(std::int32_t basin) const {
    return lowest_[static_cast<std::size_t>(basin)];
  }

 private:
  [[nodiscard]] std::span<const std::uint32_t> ring(std::uint32_t v) const {
    return {graph_.neighbour.data() + graph_.start[v], graph_.neighbour.data() + graph_.start[v + 1]};
  }
  void note(std::int32_t label) {
    if (label >= 0) {
      const std::int32_t basin = root(label);
      if (std::ranges::find(around_, basin) == around_.end()) {
        around_.push_back(basin);
      }
    }
  }
  void add(std::uint32_t v, std::int32_t basin) {
    label_[v] = basin;
    ++size_[static_cast<std::size_t>(basin)];
  }
  /// Bigger first; of equals the one that began lower, so that the order does not hang on the 1-ring's.
  [[nodiscard]] bool bigger(std::int32_t a, std::int32_t b) const {
    const std::uint32_t size_a = size_[static_cast<std::size_t>(a)];
    const std::uint32_t size_b = size_[static_cast<std::size_t>(b)];
    return size_a != size_b ? size_a > size_b : a < b;
  }
  [[nodiscard]] std::int32_t biggest_in_second_ring(std::uint32_t v) {
    for (const std::uint32_t n : ring(v)) {
      for (const std::uint32_t second : ring(n)) {
        note(label_[second]);
      }
    }
    std::int32_t best = -1;
    for (const std::int32_t basin : around_) {
      best = best < 0 || bigger(basin, best) ? basin : best;
    }
    return best;
  }
  /// v lies between basins: the small ones are flooded by the biggest, else v is a border.
  void meet(std::uint32_t v) {
    if (options_.classical) {
      label_[v] = kBasinBorder;
      return;
    }
    std::ranges::sort(around_, [this](std::int32_t a, std::int32_t b) { return bigger(a, b); });
    const std::int32_t biggest = around_.front();
    std::size_t left = 1;
    for (std::size_t k = 1; k < around_.size(); ++k) {
      const auto basin = static_cast<std::size_t>(around_[k]);
      const auto into = static_cast<std::size_t>(biggest);
      // Of two shallow places either may be the bigger one so far.
      const float rise = height_[v] - std::max(height_[lowest_[basin]], height_[lowest_[into]]);
      if (size_[basin] < options_.min_vertices || rise < options_.min_depth_mm) {
        parent_[basin] = biggest;
        size_[into] += size_[basin];
        if (height_[lowest_[basin]] < height_[lowest_[into]]) {
          lowest_[into] = lowest_[basin];
        }
      } else {
        ++left;
      }
    }
    if (left == 1) {
      add(v, biggest);
    } else {
      label_[v] = kBasinBorder;
    }
  }

  const VertexGraph& graph_;
  std::span<const float> height_;
  const BasinOptions& options_;
  std::vector<std::int32_t>& label_;
  std::vector<std::int32_t> parent_;
  std::vector<std::uint32_t> size_, lowest_;
  std::vector<std::int32_t> around_;
};

}  // namespace

Basins find_basins(const VertexGraph& graph, std::span<const float> height_mm,
                   std::span<const std::uint8_t> free_surface, const BasinOptions& options) {
  const std::size_t count = height_mm.size();
  std::vector<std::uint32_t> order;
  Basins basins;
  basins.label.assign(count, kFreeSurfaceLabel);
  for (std::size_t v = 0; v < count; ++v) {
    if (free_surface[v] == 0 && std::isfinite(height_mm[v])) {
      order.push_back(static_cast<std::uint32_t>(v));
      basins.label[v] = kUnvisited;
    }
  }
  parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return height_mm[a] != height_mm[b] ? height_mm[a] < height_mm[b] : a < b;
  });
  Flood flood(graph, height_mm, options, &basins.label);
  for (const std::uint32_t v : order) {
    flood.visit(v);
  }

  // Number the basins that are left, then list their vertices.
  std::vector<std::int32_t> roots;
  for (std::size_t b = 0; b < flood.count(); ++b) {
    if (flood.root(static_cast<std::int32_t>(b)) == static_cast<std::int32_t>(b)) {
      roots.push_back(static_cast<std::int32_t>(b));
    }
  }
  std::ranges::sort(roots, [&](std::int32_t a, std::int32_t b) {
    const std::uint32_t low_a = flood.lowest(a);
    const std::uint32_t low_b = flood.lowest(b);
    return height_mm[low_a] != height_mm[low_b] ? height_mm[low_a] < height_mm[low_b] : low_a < low_b;
  });
  std::vector<std::int32_t> number(flood.count(), -1);
  for (std::size_t k = 0; k < roots.size(); ++k) {
    number[static_cast<std::size_t>(roots[k])] = static_cast<std::int32_t>(k);
    basins.lowest.push_back(flood.lowest(roots[k]));
  }
  basins.start.assign(roots.size() + 1, 0);
  for (const std::uint32_t v : order) {
    if (basins.label[v] >= 0) {
      basins.label[v] = number[static_cast<std::size_t>(flood.root(basins.label[v]))];
      ++basins.start[static_cast<std::size_t>(basins.label[v]) + 1];
    }
  }
  std::partial_sum(basins.start.begin(), basins.start.end(), basins.start.begin());
  basins.vertex.resize(basins.start.back());
  std::vector<std::uint32_t> next(basins.start.begin(), basins.start.end() - 1);
  for (const std::uint32_t v : order) {
    if (basins.label[v] >= 0) {
      basins.vertex[next[static_cast<std::size_t>(basins.label[v])]++] = v;
    }
  }
  return basins;
}

}  // namespace dubsar
