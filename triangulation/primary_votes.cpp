// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/primary_votes.h"

#include <algorithm>
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

/// Which of the other scans have the place of each node of a scan, and at which of their nodes: worked out
/// once, and asked for in each round.
class Rivals {
 public:
  struct Rival {
    std::uint32_t scan = 0, node = 0;
  };

  Rivals(const std::vector<OwnedScan>& scans, std::size_t self)
      : start_(scans[self].surface->lattice.size() + 1, 0) {
    const OwnedScan& scan = scans[self];
    const std::size_t nodes = start_.size() - 1;
    parallel_chunks(nodes, kGrain, [&](std::size_t begin, std::size_t end) {
      for (const Pairs* const pairs : scan.pairs) {
        for (std::size_t node = begin; node < end; ++node) {
          start_[node + 1] += pairs->match[node] >= 0 ? 1U : 0U;
        }
      }
    });
    for (std::size_t node = 0; node < nodes; ++node) {
      start_[node + 1] += start_[node];
    }
    rivals_.resize(start_.back());
    parallel_chunks(nodes, kGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> next(start_.begin() + static_cast<std::ptrdiff_t>(begin),
                                      start_.begin() + static_cast<std::ptrdiff_t>(end));
      for (std::size_t k = 0; k < scan.pairs.size(); ++k) {
        const Lattice& theirs = scans[scan.other[k]].surface->lattice;
        for (std::size_t node = begin; node < end; ++node) {
          if (const std::int32_t j = scan.pairs[k]->match[node]; j >= 0) {
            rivals_[next[node - begin]++] = {
                static_cast<std::uint32_t>(scan.other[k]),
                static_cast<std::uint32_t>(theirs.node_of(static_cast<std::size_t>(j)))};
          }
        }
      }
    });
  }

  [[nodiscard]] std::span<const Rival> at(std::size_t node) const {
    return {rivals_.data() + start_[node], rivals_.data() + start_[node + 1]};
  }

 private:
  std::vector<std::uint32_t> start_;  ///< by node, and the end
  std::vector<Rival> rivals_;
};

/// Of the scan at `self`; `wish`: how much each scan wants each of its nodes.
std::vector<float> votes_of(const StitchSurface& surface, std::size_t self, const Rivals& rivals,
                            const std::vector<std::vector<float>>& wish) {
  std::vector<float> votes(surface.lattice.size(), 0);
  parallel_chunks(votes.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      if (surface.node_sample[node] < 0) {
        continue;
      }
      const float mine = wish[self][node];
      const bool best = std::ranges::all_of(rivals.at(node), [&](const Rivals::Rival& rival) {
        const float theirs = wish[rival.scan][rival.node];
        return mine > theirs || (mine == theirs && self < rival.scan);
      });
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
  std::vector<Rivals> rivals;
  for (std::size_t self = 0; self < scans.size(); ++self) {
    if (job.cancelled()) {
      return {};
    }
    wish[self] = scans[self].surface->score;
    rivals.emplace_back(scans, self);
  }
  for (int round = 0; round <= kRounds; ++round) {
    for (std::size_t self = 0; self < scans.size(); ++self) {
      if (job.cancelled()) {
        return {};
      }
      votes[self] = votes_of(*scans[self].surface, self, rivals[self], wish);
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
