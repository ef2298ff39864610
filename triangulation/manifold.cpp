// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/manifold.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>

#include "core/disjoint_sets.h"
#include "core/parallel.h"
#include "core/parallel_erase.h"

namespace dubsar {

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kGrain = 16384;

/// The corner of the face at which it touches the vertex.
int corner_of(const Triangle& f, std::uint32_t vertex) {
  return f[0] == vertex ? 0 : f[1] == vertex ? 1 : 2;
}

/// Whether the faces around a vertex form more than one fan; no half-edge may occur twice.
bool is_pinched(std::span<const Triangle> faces, const HalfEdges& edges, std::uint32_t v) {
  const std::span<const HalfEdges::Out> outs = edges.from(v);
  if (outs.size() < 2) {
    return false;
  }
  const auto tail = [&](std::size_t o) {
    const Triangle& f = faces[outs[o].face];
    return f[static_cast<std::size_t>((corner_of(f, v) + 2) % 3)];
  };
  // To the open end of the first face's fan, if it has one, then all the way back.
  const auto neighbour = [&](std::size_t o, bool forward) {
    for (std::size_t other = 0; other < outs.size(); ++other) {
      if (forward ? outs[other].to == tail(o) : tail(other) == outs[o].to) {
        return other;
      }
    }
    return outs.size();
  };
  std::size_t first = 0;
  for (std::size_t steps = 0; steps < outs.size(); ++steps) {
    const std::size_t before = neighbour(first, false);
    if (before == outs.size() || before == 0) {
      break;
    }
    first = before;
  }
  std::size_t seen = 1;
  for (std::size_t o = neighbour(first, true); o != outs.size() && o != first; o = neighbour(o, true)) {
    if (++seen > outs.size()) {
      break;
    }
  }
  return seen != outs.size();
}

/// Keeps entry i where keep[i] != 0; empty arrays stay empty.
template <class T>
void keep_entries(std::vector<T>& values, const std::vector<std::uint32_t>& target) {
  if (values.empty()) {
    return;
  }
  std::size_t out = 0;
  for (std::size_t i = 0; i < target.size(); ++i) {
    if (target[i] != kNone) {
      values[out++] = values[i];
    }
  }
  values.resize(out);
}

}  // namespace

HalfEdges::HalfEdges(std::span<const Triangle> faces, std::size_t vertex_count,
                     std::span<const std::uint8_t> only)
    : start_(vertex_count + 1, 0) {
  const auto takes = [&](std::uint32_t v) { return only.empty() || only[v] != 0; };
  parallel_ranges(vertex_count, [&](std::size_t begin, std::size_t end) {
    for (const Triangle& f : faces) {
      for (const std::uint32_t v : f) {
        if (v >= begin && v < end && takes(v)) {
          ++start_[v + 1];
        }
      }
    }
  });
  for (std::size_t v = 0; v < vertex_count; ++v) {
    start_[v + 1] += start_[v];
  }
  out_.resize(start_.back());
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  parallel_ranges(vertex_count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const Triangle& f = faces[i];
      for (std::size_t k = 0; k < 3; ++k) {
        if (f[k] >= begin && f[k] < end && takes(f[k])) {
          out_[next[f[k]]++] = {f[(k + 1) % 3], static_cast<std::uint32_t>(i)};
        }
      }
    }
  });
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

int HalfEdges::count(std::uint32_t a, std::uint32_t b) const {
  int n = 0;
  for (const Out& out : from(a)) {
    n += out.to == b ? 1 : 0;
  }
  return n;
}

std::int64_t HalfEdges::face(std::uint32_t a, std::uint32_t b) const {
  for (const Out& out : from(a)) {
    if (out.to == b) {
      return out.face;
    }
  }
  return -1;
}

FaceComponents face_components(std::span<const Triangle> faces, const HalfEdges& edges) {
  DisjointSets sets(faces.size());
  parallel_for_each_index(
      faces.size(),
      [&](std::size_t i) {
        for (std::size_t k = 0; k < 3; ++k) {
          const std::int64_t other = edges.face(faces[i][(k + 1) % 3], faces[i][k]);
          if (other >= 0) {
            sets.unite(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(other));
          }
        }
      },
      kGrain);
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

std::vector<std::vector<std::uint32_t>> boundary_loops(std::span<const Triangle> faces,
                                                       const HalfEdges& edges) {
  std::vector<std::vector<std::uint32_t>> loops;
  std::vector<std::uint8_t> walked(3 * faces.size(), 0);
  using Starts = std::vector<std::size_t>;  // 3 face + corner
  const Starts open = parallel_reduce_ordered(
      faces.size(), kGrain, Starts{},
      [&](std::size_t begin, std::size_t end) {
        Starts found;
        for (std::size_t i = begin; i < end; ++i) {
          for (std::size_t k = 0; k < 3; ++k) {
            if (edges.face(faces[i][(k + 1) % 3], faces[i][k]) < 0) {
              found.push_back(3 * i + k);
            }
          }
        }
        return found;
      },
      [](Starts& total, const Starts& part) { total.insert(total.end(), part.begin(), part.end()); });
  for (const std::size_t start : open) {
    if (walked[start] == 0) {
      std::vector<std::uint32_t> loop;
      std::size_t face = start / 3;
      std::size_t corner = start % 3;
      while (walked[3 * face + corner] == 0) {
        walked[3 * face + corner] = 1;
        loop.push_back(faces[face][corner]);
        // Around the end vertex, face by face, until an edge has no face on its other side.
        const std::uint32_t pivot = faces[face][(corner + 1) % 3];
        corner = (corner + 1) % 3;
        for (std::size_t turn = 0; turn < faces.size(); ++turn) {
          const std::uint32_t to = faces[face][(corner + 1) % 3];
          const std::int64_t across = edges.face(to, pivot);
          if (across < 0) {
            break;
          }
          face = static_cast<std::size_t>(across);
          corner = static_cast<std::size_t>(corner_of(faces[face], pivot));
        }
      }
      loops.push_back(std::move(loop));
    }
  }
  return loops;
}

std::vector<std::uint32_t> make_manifold(std::vector<Triangle>& faces, std::size_t vertex_count,
                                         std::span<const std::uint8_t> only) {
  erase_where(faces, [](const Triangle& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; });
  HalfEdges edges(faces, vertex_count, only);
  // Which vertices have a half-edge twice is found in parallel; which face yields, in order.
  const bool repeated = parallel_reduce_ordered(
      vertex_count, 4096, false,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
          const std::span<const HalfEdges::Out> outs = edges.from(static_cast<std::uint32_t>(v));
          for (std::size_t i = 0; i < outs.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) {
              if (outs[i].to == outs[j].to) {
                return true;
              }
            }
          }
        }
        return false;
      },
      [](bool& total, bool part) { total = total || part; });
  if (repeated) {
    std::vector<std::uint8_t> gone(faces.size(), 0);
    for (std::size_t i = 0; i < faces.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        for (const HalfEdges::Out& out : edges.from(faces[i][k])) {
          if (out.to == faces[i][(k + 1) % 3] && out.face < i && gone[out.face] == 0) {
            gone[i] = 1;
          }
        }
      }
    }
    std::size_t at = 0;
    std::erase_if(faces, [&](const Triangle&) { return gone[at++] != 0; });
    edges = HalfEdges(faces, vertex_count, only);
  }
  std::vector<std::uint8_t> pinched(vertex_count, 0);
  parallel_for_each_index(
      vertex_count,
      [&](std::size_t v) { pinched[v] = is_pinched(faces, edges, static_cast<std::uint32_t>(v)) ? 1 : 0; },
      4096);
  std::vector<std::uint32_t> copies;
  std::vector<std::uint32_t> fan;
  std::vector<std::array<std::uint32_t, 3>> replaced;  // face, corner, new vertex
  for (std::uint32_t v = 0; v < vertex_count; ++v) {
    if (pinched[v] == 0) {
      continue;
    }
    const std::span<const HalfEdges::Out> outs = edges.from(v);
    fan.assign(outs.size(), kNone);
    std::uint32_t fans = 0;
    for (std::size_t first = 0; first < outs.size(); ++first) {
      if (fan[first] != kNone) {
        continue;
      }
      // Both ways round from this face; a closed fan comes back to it.
      const std::uint32_t mine = fans++;
      std::size_t at = first;
      for (bool more = true; more;) {
        more = false;
        fan[at] = mine;
        const Triangle& f = faces[outs[at].face];
        const int corner = corner_of(f, v);
        const std::uint32_t previous = f[static_cast<std::size_t>((corner + 2) % 3)];
        for (std::size_t other = 0; other < outs.size(); ++other) {
          if (fan[other] == kNone && outs[other].to == previous) {
            at = other;
            more = true;
            break;
          }
        }
      }
      at = first;
      for (bool more = true; more;) {
        more = false;
        for (std::size_t other = 0; other < outs.size(); ++other) {
          const Triangle& g = faces[outs[other].face];
          const std::uint32_t previous = g[static_cast<std::size_t>((corner_of(g, v) + 2) % 3)];
          if (fan[other] == kNone && previous == outs[at].to) {
            fan[other] = mine;
            at = other;
            more = true;
            break;
          }
        }
      }
    }
    for (std::uint32_t extra = 1; extra < fans; ++extra) {
      const auto copy = static_cast<std::uint32_t>(vertex_count + copies.size());
      copies.push_back(v);
      for (std::size_t o = 0; o < outs.size(); ++o) {
        if (fan[o] == extra) {
          const auto corner = static_cast<std::uint32_t>(corner_of(faces[outs[o].face], v));
          replaced.push_back({outs[o].face, corner, copy});
        }
      }
    }
  }
  for (const auto& [face, corner, copy] : replaced) {
    faces[face][corner] = copy;
  }
  return copies;
}

void compact_vertices(Mesh& mesh) {
  std::vector<std::uint32_t> target(mesh.positions.size(), kNone);
  parallel_ranges(target.size(), [&](std::size_t begin, std::size_t end) {
    for (const Triangle& f : mesh.faces) {
      for (const std::uint32_t v : f) {
        if (v >= begin && v < end) {
          target[v] = 0;
        }
      }
    }
  });
  std::uint32_t count = 0;
  for (std::uint32_t& t : target) {
    if (t != kNone) {
      t = count++;
    }
  }
  if (count == target.size()) {
    return;
  }
  const std::array<std::function<void()>, 7> arrays = {
      [&] { keep_entries(mesh.positions, target); },   [&] { keep_entries(mesh.normals, target); },
      [&] { keep_entries(mesh.reliability, target); }, [&] { keep_entries(mesh.sigma_mm, target); },
      [&] { keep_entries(mesh.scans, target); },       [&] { keep_entries(mesh.flags, target); },
      [&] { keep_entries(mesh.colours, target); }};
  parallel_for_each_index(
      arrays.size(), [&](std::size_t k) { arrays[k](); }, 1);
  parallel_for_each_index(
      mesh.faces.size(),
      [&](std::size_t i) {
        for (std::uint32_t& v : mesh.faces[i]) {
          v = target[v];
        }
      },
      kGrain);
}

}  // namespace dubsar
