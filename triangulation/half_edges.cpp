// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/half_edges.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "core/disjoint_sets.h"
#include "core/huge_pages.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kGrain = 16384;

}  // namespace

HalfEdges::HalfEdges(std::span<const Triangle> faces, std::size_t vertex_count,
                     std::span<const std::uint8_t> only, const JobContext& job)
    : start_(vertex_count + 1, 0) {
  const auto takes = [&](std::uint32_t v) { return only.empty() || only[v] != 0; };
  parallel_ranges(vertex_count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = 0; i < faces.size() && !job.cancelled(); ++i) {
      for (const std::uint32_t v : faces[i]) {
        if (v >= begin && v < end && takes(v)) {
          ++start_[v + 1];
        }
      }
    }
  });
  for (std::size_t v = 0; v < vertex_count; ++v) {
    start_[v + 1] += start_[v];
  }
  resize_in_huge_pages(out_, start_.back());
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  parallel_ranges(vertex_count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = 0; i < faces.size() && !job.cancelled(); ++i) {
      const Triangle& f = faces[i];
      for (std::size_t k = 0; k < 3; ++k) {
        if (f[k] >= begin && f[k] < end && takes(f[k])) {
          out_[next[f[k]]++] = {f[(k + 1) % 3], static_cast<std::uint32_t>(i)};
        }
      }
    }
  });
  sort_crowds(job);
  if (job.cancelled()) {
    start_.assign(vertex_count + 1, 0);
    out_.clear();
    crowds_.clear();
    sorted_.clear();
  }
}

std::vector<std::uint8_t> rim_vertices(std::span<const Triangle> faces, std::size_t vertex_count) {
  const auto hash = [](std::uint32_t v) {
    std::uint64_t x = (v + 1) * 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31U);
  };
  std::vector<std::uint64_t> heads_less_tails(vertex_count, 0);
  std::vector<std::uint8_t> rim(vertex_count);
  parallel_ranges(vertex_count, [&](std::size_t begin, std::size_t end) {
    const auto is_here = [&](std::uint32_t v) { return v >= begin && v < end; };
    for (const Triangle& f : faces) {
      if (!is_here(f[0]) && !is_here(f[1]) && !is_here(f[2])) {
        continue;
      }
      const std::array<std::uint64_t, 3> h = {hash(f[0]), hash(f[1]), hash(f[2])};
      for (std::size_t k = 0; k < 3; ++k) {
        if (is_here(f[k])) {
          heads_less_tails[f[k]] += h[(k + 1) % 3] - h[(k + 2) % 3];
        }
      }
    }
    for (std::size_t v = begin; v < end; ++v) {
      rim[v] = heads_less_tails[v] != 0 ? 1 : 0;
    }
  });
  return rim;
}

void HalfEdges::sort_crowds(const JobContext& job) {
  for (std::uint32_t v = 0; v < vertex_count() && !job.cancelled(); ++v) {
    const std::span<const Out> outs = from(v);
    if (outs.size() > kFew) {
      crowds_.emplace_back(v, sorted_.size());
      sorted_.insert(sorted_.end(), outs.begin(), outs.end());
      std::sort(sorted_.end() - static_cast<std::ptrdiff_t>(outs.size()), sorted_.end(),
                [](const Out& x, const Out& y) { return std::tie(x.to, x.face) < std::tie(y.to, y.face); });
    }
  }
}

std::span<const HalfEdges::Out> HalfEdges::of_crowd(std::uint32_t a, std::uint32_t b) const {
  const auto crowd = std::ranges::lower_bound(crowds_, a, {}, &std::pair<std::uint32_t, std::size_t>::first);
  const auto all = std::span(sorted_).subspan(crowd->second, from(a).size());
  const auto found = std::ranges::equal_range(all, b, {}, &Out::to);
  return {found.begin(), found.end()};
}

int HalfEdges::count(std::uint32_t a, std::uint32_t b) const {
  const std::span<const Out> outs = among(a, b);
  return static_cast<int>(outs.size() > kFew
                              ? outs.size()  // then all of them run there
                              : static_cast<std::size_t>(std::ranges::count(outs, b, &Out::to)));
}

std::int64_t HalfEdges::face(std::uint32_t a, std::uint32_t b) const {
  for (const Out& out : among(a, b)) {
    if (out.to == b) {
      return out.face;
    }
  }
  return -1;
}

std::size_t HalfEdges::rank(std::uint32_t a, std::uint32_t b, std::uint32_t face) const {
  const std::span<const Out> outs = among(a, b);
  if (outs.size() > kFew) {  // then all of them run there, the lowest face first
    return static_cast<std::size_t>(std::ranges::lower_bound(outs, face, {}, &Out::face) - outs.begin());
  }
  return static_cast<std::size_t>(
      std::ranges::count_if(outs, [&](const Out& out) { return out.to == b && out.face < face; }));
}

std::int64_t HalfEdges::face_of_rank(std::uint32_t a, std::uint32_t b, std::size_t rank) const {
  const std::span<const Out> outs = among(a, b);
  if (outs.size() > kFew) {
    return rank < outs.size() ? std::int64_t{outs[rank].face} : -1;
  }
  for (const Out& out : outs) {
    if (out.to == b && rank-- == 0) {
      return out.face;
    }
  }
  return -1;
}

std::int64_t HalfEdges::across(std::uint32_t face, std::uint32_t a, std::uint32_t b) const {
  const std::size_t at = rank(a, b, face);
  const std::int64_t opposite = face_of_rank(b, a, at);
  const bool of_two_turned_the_same = opposite < 0 && at < 2 && count(a, b) == 2 && count(b, a) == 0;
  return of_two_turned_the_same ? face_of_rank(a, b, 1 - at) : opposite;
}

FaceComponents face_components(std::span<const Triangle> faces, const HalfEdges& edges,
                               const JobContext& job) {
  DisjointSets sets(faces.size());
  parallel_chunks(faces.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && !job.cancelled(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = faces[i][k];
        const std::uint32_t b = faces[i][(k + 1) % 3];
        for (const std::int64_t other : {edges.face(b, a), edges.face(a, b)}) {
          if (other >= 0 && static_cast<std::size_t>(other) != i) {
            sets.unite(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(other));
          }
        }
      }
    }
  });
  if (job.cancelled()) {
    return {};
  }
  using Roots = std::vector<std::uint32_t>;
  FaceComponents out;
  out.of_face.resize(faces.size());
  const Roots roots = parallel_reduce_ordered(
      faces.size(), kGrain, Roots{},
      [&](std::size_t begin, std::size_t end) {
        Roots found;
        for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
          out.of_face[i] = sets.root(i);
          if (out.of_face[i] == i) {
            found.push_back(i);
          }
        }
        return found;
      },
      [](Roots& total, const Roots& part) { total.insert(total.end(), part.begin(), part.end()); });
  out.sizes.assign(roots.size(), 0);
  std::uint32_t root = kNone;
  std::uint32_t component = 0;
  for (std::uint32_t& of_face : out.of_face) {
    if (of_face != root) {
      root = of_face;
      component = static_cast<std::uint32_t>(std::ranges::lower_bound(roots, root) - roots.begin());
    }
    of_face = component;
    ++out.sizes[component];
  }
  return out;
}

}  // namespace dubsar
