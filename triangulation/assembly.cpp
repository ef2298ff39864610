// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/assembly.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <set>
#include <span>

#include "core/parallel.h"
#include "triangulation/front.h"
#include "triangulation/manifold.h"
#include "triangulation/self_intersections.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

/// Of µ; measured on simulated tablets.
constexpr float kSigmaOfInterpolated = 0.4F;

/// Sheet and per-vertex attributes grow together.
struct Draft {
  Sheet sheet;
  std::vector<float> reliability;
  std::vector<float> sigma_mm;
  std::vector<std::uint8_t> scans;
  std::vector<std::uint8_t> flags;
  struct Origin {
    std::uint32_t scan = 0;  ///< 1 for the first; 0: none, or at the rim of its patch
    std::int32_t row = 0;
    std::int32_t col = 0;
  };
  std::vector<Origin> origins;  ///< [kept samples]

  void reserve(std::size_t vertices) {
    sheet.positions.reserve(vertices);
    sheet.normals.reserve(vertices);
    sheet.spacing_mm.reserve(vertices);
    sheet.faces.reserve(2 * vertices);
    reliability.reserve(vertices);
    sigma_mm.reserve(vertices);
    scans.reserve(vertices);
    flags.reserve(vertices);
    origins.reserve(vertices);
  }
};

void add_patch(const OwnedScan& scan, std::uint32_t number, Draft& draft) {
  const StitchSurface& s = *scan.surface;
  const GridSurface g = s.surface();
  std::vector<std::uint32_t> vertex_of(scan.kept.size(), 0);
  for (std::size_t i = 0; i < scan.kept.size(); ++i) {
    if (scan.kept[i] == 0) {
      continue;
    }
    vertex_of[i] = static_cast<std::uint32_t>(draft.sheet.positions.size());
    const std::size_t at = scan.fused->slot[i];
    draft.sheet.positions.push_back(scan.fused->points[at]);
    draft.sheet.normals.push_back(s.normals[i]);
    draft.sheet.spacing_mm.push_back(static_cast<float>(s.spacing_mm));
    draft.reliability.push_back(scan.fused->reliability[at]);
    draft.sigma_mm.push_back(scan.fused->sigma_mm[at]);
    draft.scans.push_back(scan.fused->scans[at]);
    draft.flags.push_back(scan.fused->sparse[at] != 0 ? kVertexSparse : 0);
    const bool within = scan.near_kept[i] == kAllAroundKept;
    draft.origins.push_back({within ? number : 0, s.scan.grid->row_of(i), s.scan.grid->col_of(i)});
  }
  for (int row = 0; row + 1 < g.rows; ++row) {
    for (int col = 0; col + 1 < g.cols; ++col) {
      const std::uint8_t cell = scan.cells[g.index(row, col)];
      for (int which = 0; cell != 0 && which < 2; ++which) {
        if ((cell & (which == 0 ? kCellFirst : kCellSecond)) == 0) {
          continue;
        }
        std::array<std::size_t, 3> t = cell_triangle(g, row, col, cell, which);
        if (s.mirrored) {
          std::swap(t[1], t[2]);
        }
        draft.sheet.faces.push_back({vertex_of[t[0]], vertex_of[t[1]], vertex_of[t[2]]});
      }
    }
  }
}

void mark(const Triangle& f, std::vector<std::uint8_t>& marks) {
  for (const std::uint32_t v : f) {
    marks[v] = 1;
  }
}

/// One round of open_pinches() on the faces around the suspects; true when nothing had to go.
bool open_once(std::vector<Triangle>& faces, std::size_t vertex_count,
               std::span<const std::uint8_t> suspects) {
  std::vector<Triangle> split = faces;
  const std::vector<std::uint32_t> copies = make_manifold(split, vertex_count, suspects);
  if (copies.empty() && split.size() == faces.size()) {
    return true;
  }
  if (split.size() != faces.size()) {  // repeated half-edges went; look at the rest again
    faces = std::move(split);
    for (Triangle& f : faces) {
      for (std::uint32_t& v : f) {
        v = v < vertex_count ? v : copies[v - vertex_count];
      }
    }
    return false;
  }
  std::vector<std::uint32_t> fan_size(vertex_count + copies.size(), 0);
  for (const Triangle& f : split) {
    for (const std::uint32_t v : f) {
      ++fan_size[v];
    }
  }
  std::vector<std::uint32_t> largest(vertex_count);
  for (std::uint32_t v = 0; v < vertex_count; ++v) {
    largest[v] = v;
  }
  for (std::size_t k = 0; k < copies.size(); ++k) {
    const auto copy = static_cast<std::uint32_t>(vertex_count + k);
    if (fan_size[copy] > fan_size[largest[copies[k]]]) {
      largest[copies[k]] = copy;
    }
  }
  std::size_t out = 0;
  for (std::size_t i = 0; i < split.size(); ++i) {
    bool stays = true;
    for (const std::uint32_t v : split[i]) {
      const std::uint32_t original = v < vertex_count ? v : copies[v - vertex_count];
      stays = stays && largest[original] == v;
    }
    if (stays) {
      faces[out++] = faces[i];
    }
  }
  faces.resize(out);
  return false;
}

/// A vertex where patches of faces touch by a corner only keeps its largest fan: what is taken away is closed
/// again as part of the seam. Only vertices on open edges and those in `touched` can be such.
void open_pinches(std::vector<Triangle>& faces, std::size_t vertex_count,
                  const std::vector<std::uint8_t>& touched) {
  std::vector<std::uint8_t> suspects = rim_vertices(faces, vertex_count);
  for (std::size_t v = 0; v < vertex_count; ++v) {
    suspects[v] |= touched[v];
  }
  const auto is_near = [&](const Triangle& f) {
    return (suspects[f[0]] | suspects[f[1]] | suspects[f[2]]) != 0;
  };
  std::vector<Triangle> near;
  std::copy_if(faces.begin(), faces.end(), std::back_inserter(near), is_near);
  // What goes makes new suspects of its corners, and those need all of their faces.
  for (int round = 0; round < 8; ++round) {
    const std::vector<Triangle> before = near;
    if (open_once(near, vertex_count, suspects)) {
      break;
    }
    std::vector<std::uint8_t> corners(vertex_count, 0);
    std::size_t kept = 0;
    for (const Triangle& f : before) {
      if (kept < near.size() && near[kept] == f) {
        ++kept;
      } else {
        mark(f, corners);
      }
    }
    kept = 0;
    std::size_t at = 0;
    std::erase_if(faces, [&](const Triangle& f) {
      if (!is_near(f)) {
        return false;
      }
      const Triangle& was = before[at++];
      const bool stays = kept < near.size() && near[kept] == was;
      kept += stays ? 1 : 0;
      return !stays;
    });
    for (std::size_t v = 0; v < vertex_count; ++v) {
      suspects[v] |= corners[v];
    }
    near.clear();
    std::copy_if(faces.begin(), faces.end(), std::back_inserter(near), is_near);
  }
}

/// Faces around openings that could not be closed go, so that the next try has room. Returns how many.
std::size_t clear_around(Sheet& sheet, const std::vector<std::vector<std::uint32_t>>& openings) {
  std::vector<std::uint8_t> marked(sheet.positions.size(), 0);
  for (const auto& opening : openings) {
    for (const std::uint32_t v : opening) {
      marked[v] = 1;
    }
  }
  return std::erase_if(sheet.faces, [&](const Triangle& f) {
    return marked[f[0]] != 0 || marked[f[1]] != 0 || marked[f[2]] != 0;
  });
}

/// Returns the vertices of faces that were added: no others can have come to hold two fans.
std::vector<std::uint8_t> close_everything(Draft& draft, const AssemblyOptions& options, int tries) {
  std::vector<std::uint8_t> touched(draft.sheet.positions.size(), 0);
  for (int attempt = 0; attempt < tries; ++attempt) {
    open_pinches(draft.sheet.faces, draft.sheet.positions.size(), touched);
    const std::size_t first_added = draft.sheet.faces.size();
    Front front(draft.sheet);
    close_seams(front, options.seam);
    const GapFillResult filled = fill_gaps(front, options.seam, options.gap);
    const std::size_t count = draft.sheet.positions.size();
    draft.reliability.resize(count, 0.0F);
    for (std::size_t v = draft.sigma_mm.size(); v < count; ++v) {
      draft.sigma_mm.push_back(kSigmaOfInterpolated * draft.sheet.spacing_mm[v]);
    }
    draft.scans.resize(count, 0);
    draft.flags.resize(filled.first_interpolated);
    draft.flags.resize(count, kVertexInterpolated);
    touched.resize(count, 1);
    for (std::size_t f = first_added; f < draft.sheet.faces.size(); ++f) {
      mark(draft.sheet.faces[f], touched);
    }
    if (attempt + 1 == tries) {
      break;
    }
    auto openings = front.openings();
    std::erase_if(openings, [&](const auto& o) { return !is_gap(draft.sheet, o, options.gap); });
    if (openings.empty() || clear_around(draft.sheet, openings) == 0) {
      break;
    }
  }
  return touched;
}

/// By face, for self_intersections(): the scan whose grid it belongs to, if it lies in one of its cells,
/// not at the rim of a patch. Such faces all look at the scanner they come from, each at a place of its own:
/// they cannot cut each other.
std::vector<std::uint32_t> parts_of_faces(const Draft& draft) {
  std::vector<std::uint32_t> parts(draft.sheet.faces.size(), 0);
  parallel_for_each_index(
      parts.size(),
      [&](std::size_t i) {
        const Triangle& f = draft.sheet.faces[i];
        if (std::max({f[0], f[1], f[2]}) >= draft.origins.size()) {
          return;
        }
        const Draft::Origin& a = draft.origins[f[0]];
        const Draft::Origin& b = draft.origins[f[1]];
        const Draft::Origin& c = draft.origins[f[2]];
        const auto [row_lo, row_hi] = std::minmax({a.row, b.row, c.row});
        const auto [col_lo, col_hi] = std::minmax({a.col, b.col, c.col});
        if (a.scan == b.scan && b.scan == c.scan && row_hi - row_lo == 1 && col_hi - col_lo == 1) {
          parts[i] = a.scan;
        }
      },
      4096);
  return parts;
}

/// self_intersections() of the faces around the marked vertices.
std::vector<std::pair<std::uint32_t, std::uint32_t>> intersections_near(
    const Sheet& sheet, const std::vector<std::uint8_t>& marked) {
  constexpr double kAroundSpacings = 8.0;
  double reach_mm = 0;
  for (std::size_t v = 0; v < marked.size(); ++v) {
    reach_mm = marked[v] != 0 ? std::max(reach_mm, kAroundSpacings * static_cast<double>(sheet.spacing_mm[v]))
                              : reach_mm;
  }
  std::set<std::array<int, 3>> cells;
  const auto cell_of = [&](const Vector3f& p) {
    return std::array<int, 3>{static_cast<int>(std::floor(p.x() / reach_mm)),
                              static_cast<int>(std::floor(p.y() / reach_mm)),
                              static_cast<int>(std::floor(p.z() / reach_mm))};
  };
  for (std::size_t v = 0; v < marked.size(); ++v) {
    if (marked[v] != 0) {
      const auto [x, y, z] = cell_of(sheet.positions[v]);
      for (int n = 0; n < 27; ++n) {
        cells.insert({x + n % 3 - 1, y + n / 3 % 3 - 1, z + n / 9 - 1});
      }
    }
  }
  std::vector<Triangle> near;
  std::vector<std::uint32_t> index;
  for (std::uint32_t f = 0; f < sheet.faces.size(); ++f) {
    if (cells.contains(cell_of(sheet.positions[sheet.faces[f][0]]))) {
      near.push_back(sheet.faces[f]);
      index.push_back(f);
    }
  }
  auto pairs = self_intersections(sheet.positions, near);
  for (auto& [a, b] : pairs) {
    a = index[a];
    b = index[b];
  }
  return pairs;
}

/// Takes out faces that cut through each other, with those around them, and closes the place anew; what still
/// cuts at the end goes for good. Adds to the suspects of close_everything().
void repair_self_intersections(Draft& draft, const AssemblyOptions& options,
                               std::vector<std::uint8_t>& suspects) {
  constexpr int kTries = 3;
  std::vector<std::uint8_t> bad;
  for (int attempt = 0;; ++attempt) {
    const auto pairs =
        attempt == 0 ? self_intersections(draft.sheet.positions, draft.sheet.faces, parts_of_faces(draft))
                     : intersections_near(draft.sheet, bad);
    bad.assign(draft.sheet.positions.size(), 0);
    if (pairs.empty()) {
      return;
    }
    std::vector<std::uint8_t> cut(draft.sheet.faces.size(), 0);
    for (const auto& [a, b] : pairs) {
      cut[a] = cut[b] = 1;
      mark(draft.sheet.faces[a], bad);
      mark(draft.sheet.faces[b], bad);
    }
    suspects.resize(bad.size(), 0);
    const bool last = attempt == kTries;
    std::size_t at = 0;
    std::erase_if(draft.sheet.faces, [&](const Triangle& f) {
      const bool goes = cut[at++] != 0 || (attempt > 0 && !last && (bad[f[0]] | bad[f[1]] | bad[f[2]]) != 0);
      if (goes) {
        mark(f, suspects);
      }
      return goes;
    });
    if (last) {
      return;
    }
    const std::vector<std::uint8_t> touched = close_everything(draft, options, 3);
    suspects.resize(touched.size(), 0);
    for (std::size_t v = 0; v < touched.size(); ++v) {
      suspects[v] |= touched[v];
    }
  }
}

/// Drops pieces of few faces, of a manifold: there faces that share a vertex are of one piece.
void remove_pieces(Mesh& mesh, std::size_t least_faces) {
  std::vector<std::uint32_t> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) {
      parent[v] = parent[parent[v]];
      v = parent[v];
    }
    return v;
  };
  for (const Triangle& f : mesh.faces) {
    const std::uint32_t a = root(f[0]);
    for (const std::uint32_t v : {f[1], f[2]}) {
      const std::uint32_t b = root(v);
      const std::uint32_t top = root(a);
      parent[std::max(top, b)] = std::min(top, b);
    }
  }
  std::vector<std::uint32_t> size(mesh.positions.size(), 0);
  for (const Triangle& f : mesh.faces) {
    ++size[root(f[0])];
  }
  std::erase_if(mesh.faces, [&](const Triangle& f) { return size[root(f[0])] < least_faces; });
  compact_vertices(mesh);
}

}  // namespace

Mesh assemble(const std::vector<OwnedScan>& scans, const AssemblyOptions& options, const JobContext& job) {
  job.progress("join patches", 0.0);
  Draft draft;
  std::size_t vertices = 0;
  for (const OwnedScan& scan : scans) {
    vertices += static_cast<std::size_t>(
        std::count_if(scan.kept.begin(), scan.kept.end(), [](std::uint8_t k) { return k != 0; }));
  }
  draft.reserve(vertices);
  std::uint32_t number = 0;
  for (const OwnedScan& scan : scans) {
    add_patch(scan, ++number, draft);
  }
  AssemblyOptions closing = options;
  closing.gap.seen = [&scans](const Vector3f& p_mm, float radius_mm) {
    return std::any_of(scans.begin(), scans.end(), [&](const OwnedScan& scan) {
      const StitchSurface& s = *scan.surface;
      const Vector3f p = (s.scanner_from_model * p_mm.cast<double>()).cast<float>();
      return s.lookup->nearest(p, radius_mm) >= 0;
    });
  };
  job.progress("close seams", 0.0);
  std::vector<std::uint8_t> suspects = close_everything(draft, closing, 3);
  job.progress("repair intersections", 0.0);
  repair_self_intersections(draft, closing, suspects);

  job.progress("finish mesh", 0.0);
  Mesh mesh;
  mesh.faces = std::move(draft.sheet.faces);
  mesh.positions = std::move(draft.sheet.positions);
  mesh.reliability = std::move(draft.reliability);
  mesh.sigma_mm = std::move(draft.sigma_mm);
  mesh.scans = std::move(draft.scans);
  mesh.flags = std::move(draft.flags);
  const std::vector<Vector3f>& p = mesh.positions;
  std::erase_if(mesh.faces, [&](const Triangle& f) {
    return !((p[f[1]] - p[f[0]]).cast<double>().cross((p[f[2]] - p[f[0]]).cast<double>()).norm() > 0);
  });
  const std::vector<std::uint8_t> open = rim_vertices(mesh.faces, mesh.positions.size());
  for (std::size_t v = 0; v < open.size(); ++v) {
    suspects[v] |= open[v];
  }
  for (const std::uint32_t copied : make_manifold(mesh.faces, mesh.positions.size(), suspects)) {
    mesh.positions.push_back(Vector3f(mesh.positions[copied]));
    mesh.reliability.push_back(float(mesh.reliability[copied]));
    mesh.sigma_mm.push_back(float(mesh.sigma_mm[copied]));
    mesh.scans.push_back(std::uint8_t(mesh.scans[copied]));
    mesh.flags.push_back(std::uint8_t(mesh.flags[copied]));
  }
  remove_pieces(mesh, static_cast<std::size_t>(std::max(options.least_component_faces, 0)));
  // After this every vertex holds one fan: it is on the boundary when that fan is open.
  const std::vector<std::uint8_t> rim = rim_vertices(mesh.faces, mesh.positions.size());
  for (std::size_t v = 0; v < rim.size(); ++v) {
    mesh.flags[v] |= rim[v] != 0 ? kVertexBoundary : 0;
  }
  mesh.normals = vertex_normals(mesh);
  return mesh;
}

}  // namespace dubsar
