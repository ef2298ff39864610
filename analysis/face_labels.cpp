// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/face_labels.h"

#include <array>

namespace dubsar {

namespace {

constexpr double kSmallPart = 0.1;
/// On a face of fewer vertices nothing can be told from a spike.
constexpr std::uint32_t kFewVertices = 20;

/// How many neighbours have each label; the last entry counts those with none.
std::array<int, 4> votes_around(const WedgePatch& patch, const std::vector<std::int8_t>& face,
                                std::size_t v) {
  std::array<int, 4> votes{};
  for (std::uint32_t k = patch.graph.start[v]; k < patch.graph.start[v + 1]; ++k) {
    const std::int8_t label = face[patch.graph.neighbour[k]];
    ++votes[label < 0 ? 3 : static_cast<std::size_t>(label)];
  }
  return votes;
}

void filter_spikes(const WedgePatch& patch, std::vector<std::int8_t>* face) {
  const std::vector<std::int8_t> before = *face;
  for (std::size_t v = 0; v < patch.size(); ++v) {
    const std::array<int, 4> votes = votes_around(patch, before, v);
    const int all = votes[0] + votes[1] + votes[2] + votes[3];
    // A steep face may be a single row of vertices on a coarse mesh; a spike stands alone.
    if (votes[before[v] < 0 ? 3 : static_cast<std::size_t>(before[v])] > 1) {
      continue;
    }
    for (std::size_t k = 0; k < 4; ++k) {
      if (3 * votes[k] > 2 * all) {
        (*face)[v] = k == 3 ? std::int8_t{-1} : static_cast<std::int8_t>(k);
      }
    }
  }
}

/// Unlabelled vertices between labelled ones take the label that most of these have.
void close_gaps(const WedgePatch& patch, std::vector<std::int8_t>* face) {
  const std::vector<std::int8_t> before = *face;
  for (std::size_t v = 0; v < patch.size(); ++v) {
    if (before[v] >= 0) {
      continue;
    }
    const std::array<int, 4> votes = votes_around(patch, before, v);
    std::size_t most = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      most = votes[k] > votes[most] ? k : most;
    }
    if (votes[most] > votes[3] && votes[most] > 1) {
      (*face)[v] = static_cast<std::int8_t>(most);
    }
  }
}

void drop_small_parts(const WedgePatch& patch, std::vector<std::int8_t>* face) {
  std::vector<std::int32_t> part(patch.size(), -1);
  std::vector<std::uint32_t> size;
  std::array<std::uint32_t, 3> total{};
  std::vector<std::uint32_t> stack;
  for (std::uint32_t v = 0; v < patch.size(); ++v) {
    if ((*face)[v] < 0) {
      continue;
    }
    ++total[static_cast<std::size_t>(int{(*face)[v]})];
    if (part[v] >= 0) {
      continue;
    }
    const auto id = static_cast<std::int32_t>(size.size());
    size.push_back(0);
    part[v] = id;
    stack.push_back(v);
    while (!stack.empty()) {
      const std::uint32_t u = stack.back();
      stack.pop_back();
      ++size.back();
      for (std::uint32_t k = patch.graph.start[u]; k < patch.graph.start[u + 1]; ++k) {
        const std::uint32_t n = patch.graph.neighbour[k];
        if (part[n] < 0 && (*face)[n] == (*face)[u]) {
          part[n] = id;
          stack.push_back(n);
        }
      }
    }
  }
  for (std::size_t v = 0; v < patch.size(); ++v) {
    if ((*face)[v] >= 0 && size[static_cast<std::size_t>(part[v])] <
                               kSmallPart * total[static_cast<std::size_t>(int{(*face)[v]})]) {
      (*face)[v] = -1;
    }
  }
}

}  // namespace

void clean_labels(const WedgePatch& patch, std::vector<std::int8_t>* face) {
  const std::vector<std::int8_t> before = *face;
  filter_spikes(patch, face);
  close_gaps(patch, face);
  filter_spikes(patch, face);
  drop_small_parts(patch, face);
  std::array<std::uint32_t, 3> count{};
  for (const std::int8_t label : before) {
    count[label < 0 ? 0 : static_cast<std::size_t>(label)] += label < 0 ? 0 : 1;
  }
  for (std::size_t v = 0; v < face->size(); ++v) {
    if (before[v] >= 0 && (*face)[v] < 0 && count[static_cast<std::size_t>(int{before[v]})] < kFewVertices) {
      (*face)[v] = before[v];
    }
  }
}

}  // namespace dubsar
