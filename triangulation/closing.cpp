// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/closing.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "triangulation/front.h"
#include "triangulation/manifold.h"
#include "triangulation/region.h"
#include "triangulation/self_intersections.h"

namespace dubsar {

namespace {

constexpr int kTries = 9;  ///< at closing what is open in one place
constexpr int kRepairs = 3;

/// 1 for the faces that a sheet has to lose so that at each whole vertex they form one fan, the largest, and
/// no half-edge is there twice; what they lose is closed again as part of the seam. Empty when all is well.
std::vector<std::uint8_t> pinching_faces(const Sheet& sheet) {
  const auto vertex_count = static_cast<std::uint32_t>(sheet.positions.size());
  std::vector<Triangle> split = sheet.faces;
  const std::vector<std::uint32_t> copies = make_manifold(split, vertex_count, sheet.whole);
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
  for (int round = 0; round < kMostRounds; ++round) {
    const std::vector<std::uint8_t> gone = pinching_faces(region.sheet);
    if (gone.empty()) {
      return;
    }
    region.erase(gone, draft);
  }
}

/// What closing a region has left to do, as vertices of the draft.
struct Leftover {
  std::vector<std::vector<std::uint32_t>> gaps;  ///< walks around openings that should be closed
  std::vector<std::uint32_t> pinched;            ///< corners of faces that pinching_faces() names

  [[nodiscard]] std::vector<std::uint32_t> vertices() const {
    std::vector<std::uint32_t> all = pinched;
    for (const auto& gap : gaps) {
      all.insert(all.end(), gap.begin(), gap.end());
    }
    return all;
  }
};

Leftover close_region(Region& region, Draft& draft, const ClosingOptions& options) {
  open_pinches(region, draft);
  Front front(region.sheet);
  close_seams(front, options.seam);
  const GapFillResult filled = fill_gaps(front, options.seam, options.gap);
  const std::size_t base = draft.mesh.positions.size();
  region.put_back(draft, filled.first_interpolated);
  const std::size_t from_draft = region.sheet.positions.size() - (draft.mesh.positions.size() - base);
  const auto in_draft = [&](std::uint32_t v) {
    return v < from_draft ? region.vertex(v) : static_cast<std::uint32_t>(base + v - from_draft);
  };
  Leftover left;
  left.gaps = front.openings();
  std::erase_if(left.gaps, [&](const auto& o) { return !is_gap(region.sheet, o, options.gap); });
  for (auto& gap : left.gaps) {
    std::transform(gap.begin(), gap.end(), gap.begin(), in_draft);
  }
  const std::vector<std::uint8_t> pinching = pinching_faces(region.sheet);
  for (std::size_t k = 0; k < pinching.size(); ++k) {
    if (pinching[k] != 0) {
      for (const std::uint32_t v : region.sheet.faces[k]) {
        left.pinched.push_back(in_draft(v));
      }
    }
  }
  return left;
}

/// Faces around openings that could not be closed go, so that the next try has room.
void clear_around(Region& region, const std::vector<std::vector<std::uint32_t>>& gaps, Draft& draft) {
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

void close_with_tries(Draft& draft, Region region, const ClosingOptions& options) {
  Leftover left = close_region(region, draft, options);
  for (int more = 1; more < kTries; ++more) {
    const std::vector<std::uint32_t> seeds = left.vertices();
    if (seeds.empty()) {
      return;
    }
    Region again(draft, vertices_near(draft, seeds));
    clear_around(again, left.gaps, draft);
    left = close_region(again, draft, options);
  }
}

using FacePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

FacePairs all_intersections(const Draft& draft) {
  std::vector<std::uint32_t> patch(draft.mesh.faces.size());
  parallel_for_each_index(
      patch.size(), [&](std::size_t f) { patch[f] = draft.patch_of_face(f); }, 16384);
  return self_intersections(draft.mesh.positions, draft.mesh.faces, patch);
}

FacePairs intersections_in(const Region& region) {
  FacePairs pairs = self_intersections(region.sheet.positions, region.sheet.faces);
  for (auto& [a, b] : pairs) {
    a = region.face(a);
    b = region.face(b);
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

void close_patches(Draft& draft, const ClosingOptions& options) {
  close_with_tries(draft, Region(draft, draft.near_rim), options);
}

void repair_self_intersections(Draft& draft, const ClosingOptions& options) {
  FacePairs pairs = all_intersections(draft);
  for (int attempt = 0; !pairs.empty(); ++attempt) {
    const bool last = attempt == kRepairs;
    std::vector<std::uint32_t> corners = corners_of(draft, pairs);
    Region region(draft, vertices_near(draft, corners));
    std::vector<std::uint8_t> cut(region.sheet.positions.size(), 0);
    for (const std::uint32_t v : corners) {
      cut[region.local(v)] = 1;
    }
    std::vector<std::uint32_t> cutting;
    for (const auto& [a, b] : pairs) {
      cutting.push_back(a);
      cutting.push_back(b);
    }
    std::sort(cutting.begin(), cutting.end());
    std::vector<std::uint8_t> gone(region.sheet.faces.size(), 0);
    for (std::size_t k = 0; k < gone.size(); ++k) {
      const Triangle& f = region.sheet.faces[k];
      const bool beside = attempt > 0 && !last && (cut[f[0]] | cut[f[1]] | cut[f[2]]) != 0;
      gone[k] = beside || std::binary_search(cutting.begin(), cutting.end(), region.face(k)) ? 1 : 0;
    }
    region.erase(gone, draft);
    if (last) {
      return;
    }
    const std::size_t faces_before = draft.mesh.faces.size();
    close_with_tries(draft, std::move(region), options);
    for (std::size_t f = faces_before; f < draft.mesh.faces.size(); ++f) {
      corners.insert(corners.end(), draft.mesh.faces[f].begin(), draft.mesh.faces[f].end());
    }
    pairs = intersections_in(Region(draft, vertices_near(draft, corners)));
  }
}

}  // namespace dubsar
