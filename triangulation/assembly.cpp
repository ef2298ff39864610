// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/assembly.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "core/disjoint_sets.h"
#include "core/parallel_erase.h"
#include "triangulation/closing.h"
#include "triangulation/draft.h"
#include "triangulation/manifold.h"
#include "triangulation/parted_fans.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

/// Drops pieces of few faces, of a manifold: there faces that share a vertex are of one piece.
void remove_pieces(Mesh& mesh, std::size_t least_faces) {
  constexpr std::size_t kGrain = 16384;
  DisjointSets pieces(mesh.positions.size());
  parallel_for_each_index(
      mesh.faces.size(),
      [&](std::size_t i) {
        pieces.unite(mesh.faces[i][0], mesh.faces[i][1]);
        pieces.unite(mesh.faces[i][0], mesh.faces[i][2]);
      },
      kGrain);
  // Faces beside each other are mostly of one piece: counted run by run.
  using Runs = std::vector<std::pair<std::uint32_t, std::size_t>>;  // piece, faces
  const Runs runs = parallel_reduce_ordered(
      mesh.faces.size(), kGrain, Runs{},
      [&](std::size_t begin, std::size_t end) {
        Runs found;
        for (std::size_t i = begin; i < end; ++i) {
          const std::uint32_t piece = pieces.root(mesh.faces[i][0]);
          if (found.empty() || found.back().first != piece) {
            found.emplace_back(piece, 0);
          }
          ++found.back().second;
        }
        return found;
      },
      [](Runs& total, const Runs& part) { total.insert(total.end(), part.begin(), part.end()); });
  std::map<std::uint32_t, std::size_t> faces_of;
  for (const auto& [piece, faces] : runs) {
    faces_of[piece] += faces;
  }
  std::erase_if(faces_of, [&](const auto& piece) { return piece.second >= least_faces; });
  if (!faces_of.empty()) {
    erase_where(mesh.faces, [&](const Triangle& f) { return faces_of.contains(pieces.root(f[0])); });
  }
  compact_vertices(mesh);
}

}  // namespace

Mesh assemble(const std::vector<OwnedScan>& scans, const AssemblyOptions& options,
              const std::function<void()>& laid, const JobContext& job) {
  job.progress("join patches", 0.0);
  Draft draft = lay_patches(scans, job);
  if (job.cancelled()) {
    return {};
  }
  laid();
  ClosingOptions closing{options.seam, options.gap};
  closing.gap.samples_near = [&scans](const Vector3f& p_mm, float radius_mm) {
    std::vector<Vector3f> found;
    for (const OwnedScan& scan : scans) {
      const StitchSurface& s = *scan.surface;
      const Vector3f p = (s.scanner_from_model * s.as_posed(p_mm).cast<double>()).cast<float>();
      if (const GridLookup::Found nearest = s.lookup->find_nearest(p, radius_mm); nearest.sample >= 0) {
        found.push_back(
            s.moved_back((s.scanner_from_model.inverse() * nearest.point_mm.cast<double>()).cast<float>()));
      }
    }
    return found;
  };
  job.progress("close seams", 0.0);
  close_patches(draft, closing, job);
  if (job.cancelled()) {
    return {};
  }
  job.progress("repair intersections", 0.0);
  repair_self_intersections(draft, closing, job);
  if (job.cancelled()) {
    return {};
  }
  const auto goes_on = [&](int steps) {
    if (!job.cancelled()) {
      job.progress("finish mesh", steps / 5.0);
    }
    return !job.cancelled();
  };
  if (!goes_on(0)) {
    return {};
  }
  Mesh& mesh = draft.mesh;
  const std::vector<Vector3f>& p = mesh.positions;
  erase_where(mesh.faces, [&](const Triangle& f) {
    return is_gone(f) ||
           !((p[f[1]] - p[f[0]]).cast<double>().cross((p[f[2]] - p[f[0]]).cast<double>()).norm() > 0);
  });
  if (!goes_on(1)) {
    return {};
  }
  colour_added(draft, job);
  part_fans(draft, job);
  if (!goes_on(2)) {
    return {};
  }
  mesh.normals.clear();
  remove_pieces(mesh, static_cast<std::size_t>(std::max(options.least_component_faces, 0)));
  if (!goes_on(3)) {
    return {};
  }
  // After this every vertex holds one fan: it is on the boundary when that fan is open.
  const std::vector<std::uint8_t> rim = rim_vertices(mesh.faces, mesh.positions.size());
  for (std::size_t v = 0; v < rim.size(); ++v) {
    mesh.flags[v] |= rim[v] != 0 ? kVertexBoundary : 0;
  }
  if (!goes_on(4)) {
    return {};
  }
  mesh.normals = vertex_normals(mesh);
  goes_on(5);
  return std::move(mesh);
}

}  // namespace dubsar
