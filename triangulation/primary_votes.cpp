// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/primary_votes.h"

#include <utility>

#include "core/parallel.h"
#include "triangulation/patch_shape.h"

namespace dubsar {

namespace {

constexpr std::size_t kGrain = 2048;
/// A scan that has all places around may see a place this much worse than another and has it, too: seams cost
/// time and thin triangles, and what sees a place a little worse still counts in the average there.
constexpr float kGainOfNeighbours = 0.3F;
constexpr int kNeighbourNodes = 3;
constexpr int kRounds = 3;  ///< further ones move little

/// Of the scan at `self`; `wish`: how much each scan wants each of its nodes.
std::vector<float> votes_of(const std::vector<OwnedScan>& scans, std::size_t self,
                            const std::vector<std::vector<float>>& wish) {
  const OwnedScan& scan = scans[self];
  std::vector<float> votes(scan.surface->lattice.size(), 0);
  parallel_chunks(votes.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      if (scan.surface->node_sample[node] < 0) {
        continue;
      }
      const float mine = wish[self][node];
      bool best = true;
      for (std::size_t k = 0; best && k < scan.pairs.size(); ++k) {
        const std::size_t other = scan.other[k];
        if (const std::int32_t j = scan.pairs[k]->match[node]; j >= 0) {
          const float theirs =
              wish[other][scans[other].surface->lattice.node_of(static_cast<std::size_t>(j))];
          best = mine > theirs || (mine == theirs && self < other);
        }
      }
      votes[node] = best ? 1.0F : -1.0F;
    }
  });
  return votes;
}

/// The scan's score, more where it has the places around and less where others have them.
std::vector<float> wish_of(const StitchSurface& surface, std::vector<float> votes) {
  const Lattice& lattice = surface.lattice;
  std::vector<std::uint8_t> seen(lattice.size());
  for (std::size_t node = 0; node < seen.size(); ++node) {
    seen[node] = surface.node_sample[node] >= 0 ? 1 : 0;
  }
  box_mean(votes, seen, lattice.node_rows, lattice.node_cols, kNeighbourNodes);
  for (std::size_t node = 0; node < votes.size(); ++node) {
    votes[node] = surface.score[node] * (1.0F + kGainOfNeighbours * votes[node]);
  }
  return votes;
}

}  // namespace

std::vector<std::vector<float>> primary_votes(const std::vector<OwnedScan>& scans, const JobContext& job) {
  std::vector<std::vector<float>> wish(scans.size()), votes(scans.size());
  for (std::size_t self = 0; self < scans.size(); ++self) {
    wish[self] = scans[self].surface->score;
  }
  for (int round = 0; round <= kRounds; ++round) {
    for (std::size_t self = 0; self < scans.size(); ++self) {
      if (job.cancelled()) {
        return {};
      }
      votes[self] = votes_of(scans, self, wish);
    }
    for (std::size_t self = 0; round < kRounds && self < scans.size(); ++self) {
      wish[self] = wish_of(*scans[self].surface, votes[self]);
    }
  }
  return votes;
}

std::vector<std::uint8_t> wanted_samples(const StitchSurface& surface, std::span<const float> votes,
                                         int least) {
  const Lattice& lattice = surface.lattice;
  // For a sample the four nodes around it count, by how near they are.
  const auto before = [](int at) { return (at + Lattice::kNodeSide / 2) / Lattice::kNodeSide - 1; };
  const auto past = [&](int at) {
    return (static_cast<float>(at) + 0.5F) / Lattice::kNodeSide - 0.5F - static_cast<float>(before(at));
  };
  std::vector<std::uint8_t> out(surface.usable.size(), 0);
  parallel_for_each_index(
      static_cast<std::size_t>(lattice.rows),
      [&](std::size_t r) {
        const int row = static_cast<int>(r);
        std::vector<float> along(static_cast<std::size_t>(lattice.node_cols) + 2,
                                 0.0F);  // none at either end
        for (const int node_row : {before(row), before(row) + 1}) {
          const float weight = node_row == before(row) ? 1.0F - past(row) : past(row);
          for (int c = 0; node_row >= 0 && node_row < lattice.node_rows && c < lattice.node_cols; ++c) {
            along[static_cast<std::size_t>(c) + 1] += weight * votes[lattice.node(node_row, c)];
          }
        }
        for (int col = 0; col < lattice.cols; ++col) {
          const std::size_t i = r * static_cast<std::size_t>(lattice.cols) + static_cast<std::size_t>(col);
          const auto k = static_cast<std::size_t>(before(col) + 1);
          const float sum = (1.0F - past(col)) * along[k] + past(col) * along[k + 1];
          out[i] = surface.usable[i] != 0 && sum > 0 ? 1 : 0;
        }
      },
      16);
  drop_scattered(out, {}, lattice, least);
  return out;
}

}  // namespace dubsar
