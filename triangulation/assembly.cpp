// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/assembly.h"

#include <algorithm>
#include <limits>

#include "core/parallel.h"
#include "triangulation/front.h"
#include "triangulation/manifold.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

/// Sheet and per-vertex attributes grow together.
struct Draft {
  Sheet sheet;
  std::vector<float> reliability;
  std::vector<std::uint8_t> scans;
  std::vector<std::uint8_t> flags;
};

void add_patch(const OwnedScan& scan, Draft& draft) {
  const StitchSurface& s = *scan.surface;
  const GridSurface g = s.surface();
  std::vector<std::uint32_t> vertex_of(scan.kept.size(), 0);
  for (std::size_t i = 0; i < scan.kept.size(); ++i) {
    if (scan.kept[i] == 0) {
      continue;
    }
    vertex_of[i] = static_cast<std::uint32_t>(draft.sheet.positions.size());
    draft.sheet.positions.push_back(scan.fused->points[i]);
    draft.sheet.normals.push_back(s.normals[i]);
    draft.sheet.spacing_mm.push_back(static_cast<float>(s.spacing_mm));
    draft.reliability.push_back(scan.fused->reliability[i]);
    draft.scans.push_back(scan.fused->scans[i]);
    const bool sparse =
        s.scan.flags != nullptr && i < s.scan.flags->size() && ((*s.scan.flags)[i] & kSparse) != 0;
    draft.flags.push_back(sparse ? kVertexSparse : 0);
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

/// A vertex where patches of faces touch by a corner only keeps its largest fan: what is taken away is closed
/// again as part of the seam.
void open_pinches(std::vector<Triangle>& faces, std::size_t vertex_count) {
  for (int round = 0; round < 8; ++round) {
    std::vector<Triangle> split = faces;
    const std::vector<std::uint32_t> copies = make_manifold(split, vertex_count);
    if (copies.empty() && split.size() == faces.size()) {
      return;
    }
    if (split.size() != faces.size()) {  // repeated half-edges went; look at the rest again
      faces.clear();
      for (const Triangle& f : split) {
        Triangle g = f;
        for (std::uint32_t& v : g) {
          v = v < vertex_count ? v : copies[v - vertex_count];
        }
        faces.push_back(g);
      }
      continue;
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

void close_everything(Draft& draft, const AssemblyOptions& options) {
  constexpr int kTries = 3;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    open_pinches(draft.sheet.faces, draft.sheet.positions.size());
    Front front(draft.sheet);
    close_seams(front, options.seam);
    const GapFillResult filled = fill_gaps(front, options.seam, options.gap);
    const std::size_t count = draft.sheet.positions.size();
    draft.reliability.resize(count, 0.0F);
    draft.scans.resize(count, 0);
    draft.flags.resize(filled.first_interpolated);
    draft.flags.resize(count, kVertexInterpolated);
    if (attempt + 1 == kTries) {
      break;
    }
    auto openings = front.openings();
    std::erase_if(openings, [&](const auto& o) { return !is_gap(draft.sheet, o, options.gap); });
    if (openings.empty() || clear_around(draft.sheet, openings) == 0) {
      break;
    }
  }
}

}  // namespace

Mesh assemble(const std::vector<OwnedScan>& scans, const AssemblyOptions& options) {
  Draft draft;
  for (const OwnedScan& scan : scans) {
    add_patch(scan, draft);
  }
  close_everything(draft, options);

  Mesh mesh;
  mesh.faces = std::move(draft.sheet.faces);
  mesh.positions = std::move(draft.sheet.positions);
  mesh.reliability = std::move(draft.reliability);
  mesh.scans = std::move(draft.scans);
  mesh.flags = std::move(draft.flags);
  const std::vector<Vector3f>& p = mesh.positions;
  std::erase_if(mesh.faces, [&](const Triangle& f) {
    return !((p[f[1]] - p[f[0]]).cast<double>().cross((p[f[2]] - p[f[0]]).cast<double>()).norm() > 0);
  });
  for (const std::uint32_t copied : make_manifold(mesh.faces, mesh.positions.size())) {
    mesh.positions.push_back(Vector3f(mesh.positions[copied]));
    mesh.reliability.push_back(float(mesh.reliability[copied]));
    mesh.scans.push_back(std::uint8_t(mesh.scans[copied]));
    mesh.flags.push_back(std::uint8_t(mesh.flags[copied]));
  }
  remove_small_components(mesh, static_cast<std::size_t>(std::max(options.least_component_faces, 0)));
  const HalfEdges edges(mesh.faces, mesh.positions.size());
  for (const Triangle& f : mesh.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (edges.face(f[(k + 1) % 3], f[k]) < 0) {
        mesh.flags[f[k]] |= kVertexBoundary;
        mesh.flags[f[(k + 1) % 3]] |= kVertexBoundary;
      }
    }
  }
  mesh.normals = vertex_normals(mesh);
  return mesh;
}

}  // namespace dubsar
