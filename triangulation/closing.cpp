// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/closing.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "triangulation/front.h"
#include "triangulation/manifold.h"
#include "triangulation/outer_rims.h"
#include "triangulation/region.h"
#include "triangulation/self_intersections.h"
#include "triangulation/slivers.h"
#include "triangulation/tiling.h"

namespace dubsar {

namespace {

constexpr int kTiledRounds = 4;
constexpr int kTries = 9;  ///< at closing what is open in one place, after those
constexpr int kRepairs = 3;
constexpr double kMinCreaseCos = -0.2;  ///< a little beyond a right angle, for the normals of noisy samples

/// 1 for the faces that a sheet has to lose so that at each of the vertices `where` they form one fan, the
/// largest, and no half-edge is there twice; what they lose is closed again as part of the seam. Empty when
/// all is well.
std::vector<std::uint8_t> pinching_faces(const Sheet& sheet, std::span<const std::uint8_t> where) {
  const auto vertex_count = static_cast<std::uint32_t>(sheet.positions.size());
  std::vector<Triangle> split = sheet.faces;
  const std::vector<std::uint32_t> copies = make_manifold(split, vertex_count, where);
  if (copies.empty() && split.size() == sheet.faces.size()) {
    return {};
  }
  const auto original = [&](std::uint32_t v) { return v < vertex_count ? v : copies[v - vertex_count]; };
  std::vector<std::uint8_t> gone(sheet.faces.size(), 0);
  if (split.size() != sheet.faces.size()) {  // repeated half-edges; fans are for the next look
    std::size_t at = 0;
    for (std::size_t k = 0; k < sheet.faces.size(); ++k) {
      const bool stays = at < split.size() && Triangle{original(split[at][0]), original(split[at][1]),
                                                       original(split[at][2])} == sheet.faces[k];
      at += stays ? 1 : 0;
      gone[k] = stays ? 0 : 1;
    }
    return gone;
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
  for (std::size_t k = 0; k < split.size(); ++k) {
    for (const std::uint32_t v : split[k]) {
      gone[k] |= largest[original(v)] == v ? 0 : 1;
    }
  }
  return gone;
}

void open_pinches(Region& region, Draft& draft) {
  constexpr int kMostRounds = 8;
  const Sheet& sheet = region.sheet;
  for (int round = 0; round < kMostRounds; ++round) {
    std::vector<std::uint8_t> on_rim = rim_vertices(sheet.faces, sheet.positions.size());
    for (std::size_t v = 0; v < on_rim.size(); ++v) {
      on_rim[v] &= sheet.whole[v];
    }
    const std::vector<std::uint8_t> gone = pinching_faces(sheet, on_rim);
    if (gone.empty() || region.erase(gone, draft) == 0) {
      return;
    }
  }
}

using Walks = std::vector<std::vector<std::uint32_t>>;

/// What a round of closing has left to do.
struct Leftover {
  Walks gaps;  ///< around openings that should be closed and could not be
  std::vector<std::uint32_t>
      others;  ///< vertices of what is pinched, had no room, or may be a piece's outside

  void append(Leftover more) {
    std::move(more.gaps.begin(), more.gaps.end(), std::back_inserter(gaps));
    others.insert(others.end(), more.others.begin(), more.others.end());
  }
  [[nodiscard]] std::vector<std::uint32_t> vertices() const {
    std::vector<std::uint32_t> all = others;
    for (const auto& gap : gaps) {
      all.insert(all.end(), gap.begin(), gap.end());
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }
};

/// Of a region that was worked on, as vertices of its sheet.
Leftover left_open(const Front& front, const ClosingOptions& options) {
  const Sheet& sheet = front.sheet();
  Leftover left;
  for (const Front::Edge& edge : edges_without_room(front, options.seam)) {
    left.others.insert(left.others.end(), {edge.a, edge.b});
  }
  OuterRims outer_rims(sheet);
  const LooseVertices loose(sheet);
  for (Front::Walk& walk : front.walks()) {
    const bool gap = !walk.leaves && is_gap(sheet, walk.vertices, loose, options.gap);
    // Whether it is the outside of a piece shows in the next round, which sees more of it.
    const bool outside = gap && outer_rims.contain(walk.vertices);
    if (has_room(sheet, walk.vertices, options.seam) && !outside) {
      if (gap) {
        left.gaps.push_back(std::move(walk.vertices));
      }
    } else if (gap || walk.leaves) {
      left.others.insert(left.others.end(), walk.vertices.begin(), walk.vertices.end());
    }
  }
  std::vector<std::uint8_t> worked_at(sheet.positions.size());
  for (std::uint32_t v = 0; v < worked_at.size(); ++v) {
    worked_at[v] = sheet.whole[v] != 0 && front.was_on_front(v) ? 1 : 0;
  }
  const std::vector<std::uint8_t> pinching = pinching_faces(sheet, worked_at);
  for (std::size_t k = 0; k < pinching.size(); ++k) {
    if (pinching[k] != 0) {
      left.others.insert(left.others.end(), sheet.faces[k].begin(), sheet.faces[k].end());
    }
  }
  return left;
}

/// Faces around openings that could not be closed go, so that the next try has room.
void clear_around(Region& region, const Walks& gaps, Draft& draft) {
  if (gaps.empty()) {
    return;
  }
  std::vector<std::uint8_t> marked(region.sheet.positions.size(), 0);
  for (const auto& gap : gaps) {
    for (const std::uint32_t v : gap) {
      marked[region.local(v)] = 1;
    }
  }
  std::vector<std::uint8_t> gone(region.sheet.faces.size(), 0);
  for (std::size_t k = 0; k < gone.size(); ++k) {
    const Triangle& f = region.sheet.faces[k];
    gone[k] = marked[f[0]] | marked[f[1]] | marked[f[2]];
  }
  region.erase(gone, draft);
}

/// What is open still may be a crack along an edge of the body, on both sides of which scans end.
void close_over_creases(Front& front, const ClosingOptions& options, const JobContext& job) {
  Walks openings = front.openings();
  const LooseVertices loose(front.sheet());
  std::erase_if(openings, [&](const auto& o) {  // a gap without room waits for a round that has it
    return is_gap(front.sheet(), o, loose, options.gap) && !has_room(front.sheet(), o, options.seam);
  });
  SeamOptions seam = options.seam;
  seam.most_gap_edge_factor = seam.most_edge_factor;
  seam.min_crease_cos = kMinCreaseCos;
  close_openings(front, openings, seam.least_angle_rad, seam, job);
}

struct Closed {
  std::size_t first_interpolated = 0;
  Leftover left;
};

/// Of a job that is cancelled no good.
Closed close_region(Region& region, const Walks& gaps, Draft& draft, const ClosingOptions& options,
                    const JobContext& job) {
  clear_around(region, gaps, draft);
  open_pinches(region, draft);
  Front front(region.sheet);
  close_seams(front, options.seam, job);
  if (job.cancelled()) {
    return {};
  }
  const GapFillResult filled = fill_gaps(front, options.seam, options.gap, job);
  if (job.cancelled()) {
    return {};
  }
  close_over_creases(front, options, job);
  if (job.cancelled()) {
    return {};
  }
  return {filled.first_interpolated, left_open(front, options)};
}

/// In the first rounds tile by tile, side by side; what lies across two of them waits for a round in which
/// they lie elsewhere, or for those without tiles.
Tiling tiling_of(const Draft& draft, std::span<const std::uint8_t> near, int round,
                 const ClosingOptions& options) {
  struct Extent {
    Eigen::AlignedBox3f box;
    float coarsest_mm = 0;
    std::size_t count = 0;
  };
  const Extent extent = parallel_reduce_ordered(
      near.size(), 65536, Extent{},
      [&](std::size_t begin, std::size_t end) {
        Extent part;
        for (std::size_t v = begin; v < end; ++v) {
          if (near[v] != 0) {
            part.box.extend(draft.mesh.positions[v]);
            part.coarsest_mm = std::max(part.coarsest_mm, draft.spacing_mm(static_cast<std::uint32_t>(v)));
            ++part.count;
          }
        }
        return part;
      },
      [](Extent& total, const Extent& part) {
        total.box.extend(part.box);
        total.coarsest_mm = std::max(total.coarsest_mm, part.coarsest_mm);
        total.count += part.count;
      });
  if (round >= kTiledRounds || extent.count < options.least_tiled_vertices) {
    return {};
  }
  return {extent.box, static_cast<float>(options.tile_spacings) * extent.coarsest_mm,
          0.5F * static_cast<float>(round % 2)};
}

/// One round: closes what is open around near vertices. `gaps` are those that an earlier one left. A job that
/// is cancelled leaves nothing over, and a draft that is no good.
Leftover close_round(Draft& draft, std::span<const std::uint8_t> near, Walks gaps, int round,
                     const ClosingOptions& options, const JobContext& job) {
  const Tiling tiling = tiling_of(draft, near, round, options);
  std::vector<Region> regions = take_regions(draft, near, tiling);
  std::vector<Walks> gaps_in(tiling.size());
  Leftover left;
  for (auto& gap : gaps) {
    const std::size_t tile = tiling.tile_of(draft.mesh.positions[gap.front()]);
    const Eigen::AlignedBox3f room = tiling.box(tile);
    const bool fits = std::all_of(gap.begin(), gap.end(), [&](std::uint32_t v) {
      return lies_within(room, draft.mesh.positions[v], gap_reach_mm(draft.spacing_mm(v), options.seam));
    });
    (fits ? gaps_in[tile] : left.gaps).push_back(std::move(gap));
  }
  std::vector<Closed> closed(regions.size());
  // The largest first, whoever is free: none of them is left for the end, when others have nothing to do.
  std::vector<std::size_t> order(regions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater<>(),
                           [&](std::size_t k) { return regions[k].sheet.faces.size(); });
  std::atomic<std::size_t> next{0};
  parallel_for_each_index(
      regions.size(),
      [&](std::size_t) {
        const std::size_t k = order[next++];
        if (job.cancelled()) {
          return;
        }
        closed[k] = close_region(regions[k], gaps_in[regions[k].tile()], draft, options, job);
      },
      1);
  if (job.cancelled()) {
    return {};
  }
  for (std::size_t k = 0; k < regions.size(); ++k) {
    const Region& region = regions[k];
    const std::size_t base = draft.mesh.positions.size();
    region.put_back(draft, closed[k].first_interpolated);
    const auto to_draft = [&](std::uint32_t& v) {
      v = v < region.taken() ? region.vertex(v) : static_cast<std::uint32_t>(base + v - region.taken());
    };
    for (auto& gap : closed[k].left.gaps) {
      std::for_each(gap.begin(), gap.end(), to_draft);
    }
    std::for_each(closed[k].left.others.begin(), closed[k].left.others.end(), to_draft);
    left.append(std::move(closed[k].left));
  }
  return left;
}

/// Closes what is open around near vertices, round by round.
void close_around(Draft& draft, std::vector<std::uint8_t> near, const ClosingOptions& options,
                  const JobContext& job) {
  Walks gaps;
  std::vector<std::uint32_t> before;
  std::size_t gaps_before = 0;
  for (int round = 0; round < kTiledRounds + kTries; ++round) {
    Leftover left = close_round(draft, near, std::move(gaps), round, options, job);
    if (job.cancelled()) {
      return;
    }
    std::vector<std::uint32_t> seeds = left.vertices();
    if (seeds.empty() || (seeds == before && left.gaps.size() == gaps_before)) {
      return;
    }
    near = vertices_near(draft, seeds);
    gaps = std::move(left.gaps);
    before = std::move(seeds);
    gaps_before = gaps.size();
  }
}

using FacePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

FacePairs all_intersections(const Draft& draft, const ClosingOptions& options, const JobContext& job) {
  std::vector<std::uint32_t> patch(draft.mesh.faces.size());
  parallel_for_each_index(
      patch.size(), [&](std::size_t f) { patch[f] = draft.patch_of_face(f); }, 16384);
  return self_intersections(draft.mesh.positions, draft.mesh.faces, patch, job, options.counted);
}

FacePairs intersections_near(const Draft& draft, std::span<const std::uint32_t> seeds,
                             const ClosingOptions& options, const JobContext& job) {
  FacePairs pairs;
  for (const Region& region : take_regions(draft, vertices_near(draft, seeds), Tiling())) {
    for (const auto& [a, b] :
         self_intersections(region.sheet.positions, region.sheet.faces, {}, job, options.counted)) {
      pairs.emplace_back(region.face(a), region.face(b));
    }
  }
  return pairs;
}

std::vector<std::uint32_t> corners_of(const Draft& draft, const FacePairs& pairs) {
  std::vector<std::uint32_t> corners;
  for (const auto& [a, b] : pairs) {
    corners.insert(corners.end(), draft.mesh.faces[a].begin(), draft.mesh.faces[a].end());
    corners.insert(corners.end(), draft.mesh.faces[b].begin(), draft.mesh.faces[b].end());
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

}  // namespace

void close_patches(Draft& draft, const ClosingOptions& options, const JobContext& job) {
  close_around(draft, draft.near_rim, options, job);
  if (!job.cancelled()) {
    remove_slivers(draft, draft.first_face.back(), job);
  }
}

void repair_self_intersections(Draft& draft, const ClosingOptions& options, const JobContext& job) {
  if (job.cancelled()) {
    return;
  }
  FacePairs pairs = all_intersections(draft, options, job);
  for (int attempt = 0; !pairs.empty() && !job.cancelled(); ++attempt) {
    const bool last = attempt == kRepairs;
    std::vector<std::uint32_t> corners = corners_of(draft, pairs);
    const std::vector<std::uint8_t> near = vertices_near(draft, corners);
    std::vector<std::uint32_t> cutting;
    for (const auto& [a, b] : pairs) {
      cutting.push_back(a);
      cutting.push_back(b);
    }
    std::sort(cutting.begin(), cutting.end());
    for (Region& region : take_regions(draft, near, Tiling())) {
      std::vector<std::uint8_t> cut(region.sheet.positions.size(), 0);
      for (const std::uint32_t v : corners) {
        cut[region.local(v)] = 1;
      }
      std::vector<std::uint8_t> gone(region.sheet.faces.size(), 0);
      for (std::size_t k = 0; k < gone.size(); ++k) {
        const Triangle& f = region.sheet.faces[k];
        const bool beside = attempt > 0 && !last && (cut[f[0]] | cut[f[1]] | cut[f[2]]) != 0;
        gone[k] = beside || std::binary_search(cutting.begin(), cutting.end(), region.face(k)) ? 1 : 0;
      }
      region.erase(gone, draft);
    }
    if (last) {
      return;
    }
    const std::size_t faces_before = draft.mesh.faces.size();
    close_around(draft, near, options, job);
    if (job.cancelled()) {
      return;
    }
    remove_slivers(draft, faces_before, job);
    for (std::size_t f = faces_before; f < draft.mesh.faces.size(); ++f) {
      corners.insert(corners.end(), draft.mesh.faces[f].begin(), draft.mesh.faces[f].end());
    }
    pairs = intersections_near(draft, corners, options, job);
  }
}

}  // namespace dubsar
