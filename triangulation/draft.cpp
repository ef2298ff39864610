// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/draft.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <iterator>

#include "core/dilated.h"
#include "core/huge_pages.h"
#include "core/parallel.h"
#include "triangulation/patch_shape.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

constexpr std::uint8_t kBoth = kCellFirst | kCellSecond;
constexpr std::size_t kRowsPerChunk = 16;
/// Samples from the rim of a patch within which closing a seam may take something away.
constexpr int kNearRimSamples = 2;
/// Where a scan without colours is primary among scans that have some: no colour of clay, and seen as such.
constexpr std::array<std::uint8_t, 3> kColourOfNone = {128, 128, 128};

/// The two triangles over a lone sample that is not kept while the four beside it are, each joined to the
/// next; empty elsewhere. Their common edge keeps the ridge, as that of a cell does.
std::vector<std::array<std::size_t, 3>> bridge(const OwnedScan& scan, std::size_t i) {
  const StitchSurface& s = *scan.surface;
  const auto width = static_cast<std::size_t>(s.lattice.cols);
  const std::size_t north = i - width, south = i + width, west = i - 1, east = i + 1;
  if (scan.kept[i] != 0 || (scan.kept[north] & scan.kept[south] & scan.kept[west] & scan.kept[east]) == 0 ||
      scan.cells[north - 1] != (kCellAntidiagonal | kCellFirst) || scan.cells[north] != kCellSecond ||
      scan.cells[west] != kCellFirst || scan.cells[i] != (kCellAntidiagonal | kCellSecond)) {
    return {};
  }
  const auto at = [&](std::size_t k) { return scan.fused->point(k); };
  const bool upright = s.normal(north).dot(s.normal(south)) > s.normal(west).dot(s.normal(east));
  using Pair = std::vector<std::array<std::size_t, 3>>;
  Pair triangles = upright ? Pair{{north, west, south}, {north, south, east}}
                           : Pair{{north, west, east}, {west, south, east}};
  for (const auto& t : triangles) {
    Vector3f n = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
    n *= s.mirrored ? -1.0F : 1.0F;
    const Vector3f measured = s.normal(t[0]) + s.normal(t[1]) + s.normal(t[2]);
    if (!(n.dot(measured) > 0.4F * n.norm() * measured.norm())) {
      return {};
    }
  }
  return triangles;
}

/// What a scan adds to a draft, laid out row by row.
class Patch {
 public:
  explicit Patch(const OwnedScan& scan)
      : scan_(&scan),
        lattice_(&scan.surface->lattice),
        vertices_(static_cast<std::size_t>(lattice_->rows) + 1, 0),
        faces_(static_cast<std::size_t>(lattice_->rows) + 1, 0),
        bridged_(scan.kept.size(), 0) {
    if (scan.kept.empty()) {
      return;
    }
    each_row([&](std::size_t row) {
      std::uint32_t vertices = 0;
      std::uint32_t faces = 0;
      for (std::size_t col = 0; col < width(); ++col) {
        const std::size_t i = row * width() + col;
        vertices += scan.kept[i];
        faces += static_cast<std::uint32_t>(((scan.cells[i] >> 1) & 1) + ((scan.cells[i] >> 2) & 1));
        if (scan.kept[i] == 0 && is_inner(row, col) && scan.kept[i - 1] != 0 && !bridge(scan, i).empty()) {
          bridged_[i] = 1;
          faces += 2;
        }
      }
      vertices_[row + 1] = vertices;
      faces_[row + 1] = faces;
    });
    for (std::size_t row = 0; row + 1 < vertices_.size(); ++row) {
      vertices_[row + 1] += vertices_[row];
      faces_[row + 1] += faces_[row];
    }
  }
  [[nodiscard]] std::uint32_t vertex_count() const {
    return vertices_.back() + static_cast<std::uint32_t>(scan_->loose.size());
  }
  [[nodiscard]] std::uint32_t face_count() const { return faces_.back(); }

  void lay(std::uint32_t first_vertex, std::uint32_t first_face, Draft& draft) const {
    if (scan_->kept.empty()) {
      return;
    }
    const StitchSurface& s = *scan_->surface;
    const FusedSamples& fused = *scan_->fused;
    const std::vector<std::uint8_t> rim = rim_samples();
    const std::vector<std::uint8_t> near_rim = dilated(rim, lattice_->rows, lattice_->cols, kNearRimSamples);
    std::vector<std::uint32_t> vertex_of(scan_->kept.size());
    Mesh& mesh = draft.mesh;
    const auto lay_vertex = [&](std::uint32_t v, std::size_t i) {
      const std::size_t at = fused.slot[i];
      mesh.positions[v] = fused.points[at];
      mesh.normals[v] = s.normal(i);
      mesh.reliability[v] = fused.reliability[at];
      mesh.sigma_mm[v] = fused.sigma_mm[at];
      mesh.scans[v] = fused.scans[at];
      mesh.flags[v] = fused.sparse[at] != 0 ? kVertexSparse : 0;
      if (!mesh.colours.empty()) {
        mesh.colours[v] = s.colours.empty() ? kColourOfNone : s.colours[i];
      }
    };
    each_row([&](std::size_t row) {
      std::uint32_t v = first_vertex + vertices_[row];
      for (std::size_t i = row * width(); i < (row + 1) * width(); ++i) {
        if (scan_->kept[i] != 0) {
          lay_vertex(v, i);
          draft.near_rim[v] = rim[i] != 0 ? Draft::kAtRim : near_rim[i];
          vertex_of[i] = v++;
        }
      }
    });
    for (std::size_t k = 0; k < scan_->loose.size(); ++k) {
      const std::uint32_t v = first_vertex + vertices_.back() + static_cast<std::uint32_t>(k);
      lay_vertex(v, scan_->loose[k]);
      draft.near_rim[v] = Draft::kLoose;
    }
    const GridSurface g = s.surface();
    each_row([&](std::size_t row) {
      std::uint32_t f = first_face + faces_[row];
      const auto add = [&](const std::array<std::size_t, 3>& t) {
        mesh.faces[f++] = {vertex_of[t[0]], vertex_of[t[s.mirrored ? 2 : 1]],
                           vertex_of[t[s.mirrored ? 1 : 2]]};
      };
      for (std::size_t col = 0; col < width(); ++col) {
        const std::size_t i = row * width() + col;
        const std::uint8_t cell = scan_->cells[i];
        for (int which = 0; cell != 0 && which < 2; ++which) {
          if ((cell & (which == 0 ? kCellFirst : kCellSecond)) != 0) {
            add(cell_triangle(g, static_cast<int>(row), static_cast<int>(col), cell, which));
          }
        }
        if (bridged_[i] != 0) {
          for (const auto& t : bridge(*scan_, i)) {
            add(t);
          }
        }
      }
    });
  }

 private:
  [[nodiscard]] std::size_t width() const { return static_cast<std::size_t>(lattice_->cols); }
  [[nodiscard]] bool is_inner(std::size_t row, std::size_t col) const {
    return row > 0 && row + 1 < static_cast<std::size_t>(lattice_->rows) && col > 0 && col + 1 < width();
  }
  template <class Visit>
  void each_row(const Visit& visit) const {
    parallel_for_each_index(static_cast<std::size_t>(lattice_->rows), visit, kRowsPerChunk);
  }
  /// 1 for the kept samples around which the patch is not whole.
  [[nodiscard]] std::vector<std::uint8_t> rim_samples() const {
    std::vector<std::uint8_t> rim(scan_->kept.size(), 0);
    const auto whole = [&](std::size_t cell) { return (scan_->cells[cell] & kBoth) == kBoth; };
    each_row([&](std::size_t row) {
      for (std::size_t col = 0; col < width(); ++col) {
        const std::size_t i = row * width() + col;
        if (scan_->kept[i] != 0) {
          rim[i] =
              is_inner(row, col) && whole(i) && whole(i - 1) && whole(i - width()) && whole(i - width() - 1)
                  ? 0
                  : 1;
        }
      }
    });
    return rim;
  }

  const OwnedScan* scan_;
  const Lattice* lattice_;
  std::vector<std::uint32_t> vertices_, faces_;  ///< [rows + 1] before each row
  std::vector<std::uint8_t> bridged_;
};

}  // namespace

void colour_added(Draft& draft, const JobContext& job) {
  Mesh& mesh = draft.mesh;
  const std::size_t first = draft.first_vertex.back();
  if (mesh.colours.empty() || mesh.positions.size() == first) {
    return;
  }
  mesh.colours.resize(mesh.positions.size(), kColourOfNone);
  std::vector<Triangle> faces;
  std::ranges::copy_if(mesh.faces, std::back_inserter(faces), [&](const Triangle& f) {
    return std::max({f[0], f[1], f[2]}) >= first && !is_gone(f);
  });
  struct Sum {
    std::array<std::uint32_t, 3> of{};
    std::uint32_t count = 0;
  };
  std::vector<std::uint8_t> known(mesh.positions.size() - first, 0);
  // From the rim inwards, a ring of vertices each time.
  for (bool any = true; any && !job.cancelled();) {
    any = false;
    std::vector<Sum> sums(known.size());
    for (const Triangle& f : faces) {
      for (const std::uint32_t v : f) {
        if (v < first || known[v - first] != 0) {
          continue;
        }
        for (const std::uint32_t w : f) {
          if (w >= first && known[w - first] == 0) {
            continue;
          }
          for (std::size_t k = 0; k < 3; ++k) {
            sums[v - first].of[k] += mesh.colours[w][k];
          }
          ++sums[v - first].count;
        }
      }
    }
    for (std::size_t k = 0; k < sums.size(); ++k) {
      if (sums[k].count > 0) {
        for (std::size_t c = 0; c < 3; ++c) {
          mesh.colours[first + k][c] =
              static_cast<std::uint8_t>((sums[k].of[c] + sums[k].count / 2) / sums[k].count);
        }
        known[k] = 1;
        any = true;
      }
    }
  }
}

float Draft::spacing_mm(std::uint32_t vertex) const {
  if (vertex >= first_vertex.back()) {
    return added_spacing_mm[vertex - first_vertex.back()];
  }
  const auto next = std::upper_bound(first_vertex.begin(), first_vertex.end(), vertex);
  return patch_spacing_mm[static_cast<std::size_t>(next - first_vertex.begin()) - 1];
}

std::uint32_t Draft::patch_of_face(std::size_t face) const {
  if (face >= first_face.back()) {
    return 0;
  }
  const Triangle& f = mesh.faces[face];
  if (std::max({near_rim[f[0]], near_rim[f[1]], near_rim[f[2]]}) == kAtRim) {
    return 0;
  }
  const auto next = std::upper_bound(first_face.begin(), first_face.end(), static_cast<std::uint32_t>(face));
  return static_cast<std::uint32_t>(next - first_face.begin());
}

Draft lay_patches(const std::vector<OwnedScan>& scans, const JobContext& job) {
  Draft draft;
  std::vector<Patch> patches;
  draft.first_vertex.push_back(0);
  draft.first_face.push_back(0);
  for (const OwnedScan& scan : scans) {
    if (job.cancelled()) {
      return draft;
    }
    const Patch& patch = patches.emplace_back(scan);
    draft.first_vertex.push_back(draft.first_vertex.back() + patch.vertex_count());
    draft.first_face.push_back(draft.first_face.back() + patch.face_count());
    draft.patch_spacing_mm.push_back(static_cast<float>(scan.surface->spacing_mm));
  }
  const std::size_t vertices = draft.first_vertex.back();
  Mesh& mesh = draft.mesh;
  // Seams and gaps add some: no array is copied for it.
  const auto lay_out = [](auto& array, std::size_t size) {
    array.reserve(size + size / 8);
    resize_in_huge_pages(array, size);
  };
  lay_out(mesh.positions, vertices);
  lay_out(mesh.normals, vertices);
  lay_out(mesh.reliability, vertices);
  lay_out(mesh.sigma_mm, vertices);
  lay_out(mesh.scans, vertices);
  lay_out(mesh.flags, vertices);
  if (std::ranges::any_of(scans, [](const OwnedScan& scan) { return !scan.surface->colours.empty(); })) {
    lay_out(mesh.colours, vertices);
  }
  lay_out(draft.near_rim, vertices);
  lay_out(mesh.faces, draft.first_face.back());
  for (std::size_t k = 0; k < patches.size() && !job.cancelled(); ++k) {
    patches[k].lay(draft.first_vertex[k], draft.first_face[k], draft);
  }
  return draft;
}

}  // namespace dubsar
