// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/stitch_entry.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>

#include "core/parallel.h"
#include "triangulation/misplacement.h"

namespace dubsar {

std::optional<FoundPairs> pairs_between(const PassKey& key, const StitchSurface& surface,
                                        const PassKey& other_key, const StitchSurface& other,
                                        const PairingOptions& options, const JobContext& job) {
  Eigen::AlignedBox3f box = other.box;
  const auto margin =
      static_cast<float>(options.most_reach_factor * std::max(surface.spacing_mm, other.spacing_mm));
  if (!box.isEmpty()) {
    box.min().array() -= margin;
    box.max().array() += margin;
  }
  if (!box.intersects(surface.box)) {
    return std::nullopt;
  }
  const double reach_mm = pair_reach_mm(surface, other, options);
  FoundPairs found{other_key,
                   find_pairs(surface, other, reach_mm, options, job),
                   find_pairs(other, surface, reach_mm, options, job),
                   {}};
  if (found.there.nodes == 0 && found.back.nodes == 0) {
    return std::nullopt;
  }
  found.there.feather = found.back.feather =
      static_cast<float>(feather_samples(surface, other, step_mm(surface, other, reach_mm)));
  if (other_key.first != key.first) {
    found.step = key < other_key ? pose_step(surface, found.there, other, found.back)
                                 : pose_step(other, found.back, surface, found.there);
  }
  return found;
}

namespace {

/// Two scans that have a step between them, and their pairs either way.
struct Linked {
  const StitchSurface* a;
  const StitchSurface* b;
  const Pairs* there;
  const Pairs* back;
};

/// Pairs are where the other scan has the same place, as the motions say, not where its pose puts it. False
/// when cancelled: then some are where they were.
bool look_for_pairs_anew(Entries& entries, const std::function<SmallMotion(const PassKey&)>& back_of,
                         const JobContext& job) {
  for (auto& [key, entry] : entries) {
    for (auto& [other_key, pairs] : entry.pairs) {
      const SmallMotion onto =
          other_key.first == key.first ? SmallMotion() : back_of(key) - back_of(other_key);
      if (onto == pairs.onto) {
        continue;
      }
      if (job.cancelled()) {
        return false;
      }
      entry.mark_changed(pairs);
      pairs = find_pairs_anew(entry.surface, entries.at(other_key).surface, std::move(pairs), onto);
      entry.mark_changed(pairs);
    }
  }
  return true;
}

}  // namespace

bool weigh_places(Entries& entries, const JobContext& job) {
  // Distances between the same places say more than those between places that poses put beside each other.
  constexpr int kRounds = 3;
  std::vector<const StitchSurface*> scans;
  std::map<int, std::size_t> place;  // by scan: passes share its pose
  for (const auto& [key, entry] : entries) {
    if (key.second == 0) {
      place[key.first] = scans.size();
      scans.push_back(&entry.surface);
    }
  }
  std::vector<Misplacement> off;
  const auto back_of = [&](const PassKey& key) { return off[place.at(key.first)].back; };
  for (int round = 0; round < kRounds; ++round) {
    std::vector<PoseLink> links;
    std::vector<Linked> linked;
    for (const auto& [key, entry] : entries) {
      for (const auto& [other_key, step] : entry.steps) {
        const Entry& other = entries.at(other_key);
        links.push_back({place.at(key.first), place.at(other_key.first), step});
        linked.push_back({&entry.surface, &other.surface, &entry.pairs.at(other_key), &other.pairs.at(key)});
      }
    }
    // Side by side: much of it is work for a single thread.
    parallel_for_each_index(
        links.size(),
        [&](std::size_t k) {
          const Linked& at = linked[k];
          // Of pairs that are where the poses put them the step is known.
          const bool as_posed = round == 0 || (at.there->onto.is_none() && at.back->onto.is_none());
          if (!as_posed && !job.cancelled()) {
            links[k].step = pose_step(*at.a, *at.there, *at.b, *at.back);
          }
        },
        1);
    if (job.cancelled()) {
      return false;
    }
    off = misplacements(scans, links);
    if (!look_for_pairs_anew(entries, back_of, job)) {
      return false;
    }
    if (std::ranges::all_of(off, [](const Misplacement& m) { return m.back.is_none(); })) {
      break;
    }
  }
  for (auto& [key, entry] : entries) {
    if (!entry.surface.take_misplacement(off[place.at(key.first)])) {
      continue;
    }
    entry.mark_all_changed();
    for (const auto& [other_key, pairs] : entry.pairs) {
      Entry& other = entries.at(other_key);
      other.mark_changed(other.pairs.at(key));
    }
  }
  return true;
}

std::vector<int> without_surface(const Entries& entries) {
  std::map<int, bool> has_surface;
  for (const auto& [key, entry] : entries) {
    has_surface[key.first] |= !entry.surface.box.isEmpty();
  }
  std::vector<int> out;
  for (const auto& [id, has] : has_surface) {
    if (!has) {
      out.push_back(id);
    }
  }
  return out;
}

std::map<int, double> moved_mm(const Entries& entries) {
  std::map<int, double> out;
  for (const auto& [key, entry] : entries) {
    const StitchSurface& s = entry.surface;
    if (key.second != 0 || s.back.is_none()) {
      continue;
    }
    double sum = 0, count = 0;
    for (const std::int32_t sample : s.node_sample) {
      if (sample >= 0) {
        const auto i = static_cast<std::size_t>(sample);
        const auto along = static_cast<double>(s.back.at(s.points[i]).dot(s.normal(i)));
        sum += 3.0 * along * along;
        ++count;
      }
    }
    out[key.first] = std::sqrt(sum / std::max(count, 1.0));
  }
  return out;
}

std::vector<std::uint32_t> unfused(const Entry& entry) {
  using Samples = std::vector<std::uint32_t>;
  const Lattice& lattice = entry.surface.lattice;
  return parallel_reduce_ordered(
      lattice.size(), 1024, Samples{},
      [&](std::size_t begin, std::size_t end) {
        Samples found;
        for (std::size_t node = begin; node < end; ++node) {
          lattice.for_each_sample(node, [&](std::size_t i) {
            if (entry.wanted[i] != 0 && entry.fused.slot[i] == FusedSamples::kNone) {
              found.push_back(static_cast<std::uint32_t>(i));
            }
          });
        }
        return found;
      },
      [](Samples& total, const Samples& part) { total.insert(total.end(), part.begin(), part.end()); });
}

}  // namespace dubsar
