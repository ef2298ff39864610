// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/wedge_corrections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <expected>
#include <iterator>
#include <set>
#include <string>
#include <unordered_map>
#include <unordered_set>

#include "analysis/hollow_measure.h"
#include "core/near_cells.h"

namespace dubsar {

namespace {

/// Of each wedge that is merged the new one must hold this share: else it would only take its place.
constexpr double kLeastShareMerged = 0.1;
/// How far from the place that was shown a depth point is looked for.
constexpr double kAroundSeedMm = 0.15;
constexpr double kAroundSeedSpacings = 3.0;

/// [bodies] How far that is on each: a coarse one says nothing of a fine one.
std::vector<double> around_seeds_mm(const SurfaceFields& fields, const std::vector<float>& area_mm2) {
  std::vector<std::vector<float>> areas(fields.body_count());
  for (std::size_t v = 0; v < area_mm2.size(); ++v) {
    areas[fields.body_of.empty() ? 0 : fields.body_of[v]].push_back(area_mm2[v]);
  }
  std::vector<double> out;
  for (const std::vector<float>& some : areas) {
    out.push_back(std::max(kAroundSeedMm, kAroundSeedSpacings * mean_spacing_mm(some)));
  }
  return out;
}

using Vertices = std::vector<std::uint32_t>;
using Made = std::expected<void, std::string>;

class Corrector {
 public:
  Corrector(const Mesh& mesh, const VertexGraph& graph, const SurfaceFields& fields,
            const WedgeOptions& options, const WedgeFindings& findings, WedgeIds* ids, WedgeSet* set)
      : mesh_(mesh),
        graph_(graph),
        fields_(fields),
        options_(options),
        findings_(findings),
        measure_quiet_(mesh, graph, fields, options, findings.area_mm2, false),
        measure_noisy_(mesh, graph, fields, options, findings.area_mm2, true),
        around_seed_mm_(around_seeds_mm(fields, findings.area_mm2)),
        slot_(mesh.positions.size(), -1),
        ids_(*ids),
        set_(*set) {
    std::size_t k = 0;
    for (const WedgeCandidate& c : findings.candidates) {
      WedgeCandidate light = c;
      light.vertices.clear();
      light.faces.clear();
      light.wedge.id = c.rejected.empty() ? set_.wedges[k++].id : -1;
      company_.push_back(std::move(light));
    }
  }

  Made make(const WedgeCorrection& correction) {
    switch (correction.kind) {
      case CorrectionKind::kDelete:
        return remove(correction);
      case CorrectionKind::kMerge:
        return merge(correction);
      case CorrectionKind::kSplit:
        return split(correction);
      case CorrectionKind::kAdd:
        return add(correction);
    }
    return {};
  }

 private:
  /// Ids of the wedges whose depth points lie at these places, each once.
  [[nodiscard]] std::expected<std::set<int>, std::string> wedges_at(
      const std::vector<Eigen::Vector3d>& places) const {
    std::set<int> ids;
    for (const Eigen::Vector3d& place : places) {
      const Wedge* nearest = nullptr;
      double off = kSamePlaceMm;
      for (const Wedge& wedge : set_.wedges) {
        if (const double away = (wedge.depth_point_mm - place).norm(); away <= off) {
          off = away;
          nearest = &wedge;
        }
      }
      if (nearest == nullptr) {
        return std::unexpected(
            fmt::format("no wedge lies at {:.3f}, {:.3f}, {:.3f} any more", place.x(), place.y(), place.z()));
      }
      if (ids_.is_of_one_gone(place, nearest->id)) {
        return std::unexpected(fmt::format(
            "the wedge that lay at {:.3f}, {:.3f}, {:.3f} is no more: wedge {} beside it is another",
            place.x(), place.y(), place.z(), nearest->id));
      }
      ids.insert(nearest->id);
    }
    return ids;
  }

  [[nodiscard]] std::size_t body_of(std::uint32_t v) const {
    return fields_.body_of.empty() ? 0 : fields_.body_of[v];
  }

  [[nodiscard]] bool is_of(std::uint32_t v, const std::set<int>& ids) const {
    return set_.wedge_of[v] >= 0 && ids.contains(set_.wedge_of[v]);
  }

  void sort_by_height(Vertices* vertices) const {
    std::ranges::sort(*vertices, [&](std::uint32_t a, std::uint32_t b) {
      const float ha = fields_.height_mm[a];
      const float hb = fields_.height_mm[b];
      return ha != hb ? ha < hb : a < b;
    });
  }

  /// Whether a border between basins runs here between two of these.
  [[nodiscard]] bool is_between(std::uint32_t v, const std::set<std::int32_t>& basins) const {
    std::set<std::int32_t> met;
    const auto meet = [&](std::uint32_t n) {
      if (basins.contains(set_.basin_of[n])) {
        met.insert(set_.basin_of[n]);
      }
    };
    for (const std::uint32_t n : graph_.ring(v)) {
      meet(n);
      std::ranges::for_each(graph_.ring(n), meet);
    }
    return met.size() > 1;
  }

  /// The vertices of these wedges, with what is left of their basins and of the borders between these, in
  /// rising height.
  [[nodiscard]] Vertices hollow_of(const std::set<int>& ids) const {
    std::set<std::int32_t> basins;
    for (std::uint32_t v = 0; v < set_.wedge_of.size(); ++v) {
      if (is_of(v, ids) && set_.basin_of[v] >= 0) {
        basins.insert(set_.basin_of[v]);
      }
    }
    Vertices out;
    for (std::uint32_t v = 0; v < set_.wedge_of.size(); ++v) {
      const bool free = set_.wedge_of[v] < 0 && fields_.height_mm[v] < 0;
      const bool border = free && basins.size() > 1 && set_.basin_of[v] == kBasinBorder;
      if (is_of(v, ids) || (free && basins.contains(set_.basin_of[v])) || (border && is_between(v, basins))) {
        out.push_back(v);
      }
    }
    sort_by_height(&out);
    return out;
  }

  std::expected<WedgeCandidate, std::string> measure(const Vertices& vertices, ByHand by_hand) {
    if (vertices.size() < measure_quiet_.least_vertices()) {
      return std::unexpected("too few vertices of the mesh");
    }
    // As the body was measured by itself, however rough another one is.
    const bool noisy = findings_.is_noisy[body_of(vertices.front())] != 0;
    const HollowMeasure& of_body = noisy ? measure_noisy_ : measure_quiet_;
    auto found = of_body.measure(vertices, &slot_);
    if (found && found->vertices.empty()) {
      return std::unexpected("nothing of the clay lies on its faces");
    }
    if (found) {
      found->wedge.by_hand = by_hand;
    }
    return found;
  }

  void take_out(const std::set<int>& ids, const char* why) {
    for (std::uint32_t v = 0; v < set_.wedge_of.size(); ++v) {
      if (is_of(v, ids)) {
        set_.wedge_of[v] = -1;
        set_.face_of[v] = -1;
      }
    }
    for (std::size_t k = set_.wedges.size(); k-- > 0;) {
      const auto at = static_cast<std::ptrdiff_t>(k);
      if (ids.contains(set_.wedges[k].id)) {
        set_.rejected.push_back({why, set_.wedges[k].depth_point_mm});
        set_.wedges.erase(set_.wedges.begin() + at);
        set_.evidence.erase(set_.evidence.begin() + at);
      }
    }
    std::erase_if(company_, [&](const WedgeCandidate& c) { return ids.contains(c.wedge.id); });
  }

  void put_in(WedgeCandidate candidate) {
    candidate.wedge.id = ids_.of_made(candidate.wedge);
    for (std::size_t i = 0; i < candidate.vertices.size(); ++i) {
      set_.wedge_of[candidate.vertices[i]] = candidate.wedge.id;
      set_.face_of[candidate.vertices[i]] = candidate.faces[i];
    }
    candidate.vertices.clear();
    candidate.faces.clear();
    company_.push_back(std::move(candidate));
    // Beside those of its own body, as what is found is.
    std::vector<WedgeCandidate> judged;
    std::ranges::copy_if(company_, std::back_inserter(judged), [&](const WedgeCandidate& one) {
      return one.wedge.place.body == company_.back().wedge.place.body;
    });
    judge_last_wedge(options_.judge, &judged);
    WedgeCandidate& c = company_.back();
    c.wedge.confidence = judged.back().wedge.confidence;  // whatever it is: a person says that it is one
    c.evidence = judged.back().evidence;
    set_.evidence.push_back(c.evidence);
    set_.wedges.push_back(c.wedge);
  }

  Made remove(const WedgeCorrection& correction) {
    const auto ids = wedges_at(correction.at_mm);
    if (!ids) {
      return std::unexpected(ids.error());
    }
    take_out(*ids, "deleted by hand");
    return {};
  }

  Made merge(const WedgeCorrection& correction) {
    const auto ids = wedges_at(correction.at_mm);
    if (!ids) {
      return std::unexpected(ids.error());
    }
    if (ids->size() < 2) {
      return std::unexpected("these are one wedge already");
    }
    auto made = measure(hollow_of(*ids), ByHand::kMerged);
    if (!made) {
      return std::unexpected("they are not measured as one wedge: " + made.error());
    }
    std::unordered_map<int, int> held;
    std::unordered_map<int, int> had;
    for (const std::uint32_t v : made->vertices) {
      ++held[set_.wedge_of[v]];
    }
    for (const std::int32_t id : set_.wedge_of) {
      ++had[id];
    }
    for (const int id : *ids) {
      if (held[id] < kLeastShareMerged * had[id]) {
        return std::unexpected(fmt::format("no one wedge holds them all: wedge {} stays outside", id));
      }
    }
    take_out(*ids, "merged by hand");
    put_in(*std::move(made));
    return {};
  }

  Made split(const WedgeCorrection& correction) {
    const auto ids = wedges_at(correction.at_mm);
    if (!ids) {
      return std::unexpected(ids.error());
    }
    // As in a basin of several wedges: each is looked for in what those before it have left.
    const Vertices hollow = hollow_of(*ids);
    Vertices left = hollow;
    std::vector<WedgeCandidate> made;
    for (std::size_t k = 0; k < correction.into_mm.size(); ++k) {
      const auto is_there = [&](std::uint32_t v) {
        return (mesh_.positions[v].cast<double>() - correction.into_mm[k]).norm() <=
               around_seed_mm_[body_of(v)];
      };
      const auto deepest = std::ranges::find_if(left, is_there);
      if (deepest == left.end()) {
        if (std::ranges::any_of(hollow, is_there)) {
          return std::unexpected(
              fmt::format("one of the places lies in the part of a place before it: number {}; say those "
                          "first that cut into the others",
                          k + 1));
        }
        return std::unexpected(fmt::format("one of the places does not lie in the wedge: number {}", k + 1));
      }
      Vertices part = left;
      std::rotate(part.begin(), part.begin() + (deepest - left.begin()),
                  part.begin() + (deepest - left.begin()) + 1);
      auto one = measure(part, ByHand::kSplit);
      if (!one) {
        return std::unexpected(
            fmt::format("one of the parts is not measured as a wedge, number {}: {}", k + 1, one.error()));
      }
      const std::unordered_set<std::uint32_t> taken(one->vertices.begin(), one->vertices.end());
      std::erase_if(left, [&](std::uint32_t v) { return taken.contains(v); });
      made.push_back(*std::move(one));
    }
    take_out(*ids, "split by hand");
    for (WedgeCandidate& part : made) {
      put_in(std::move(part));
    }
    return {};
  }

  Made add(const WedgeCorrection& correction) {
    NearCells places(std::max(correction.reach_mm, 1e-3));
    for (std::size_t r = 0; r < correction.region_mm.size(); ++r) {
      places.add(correction.region_mm[r], r);
    }
    Vertices region;
    std::size_t of_others = 0;
    for (std::uint32_t v = 0; v < mesh_.positions.size(); ++v) {
      if (!(fields_.height_mm[v] < 0)) {
        continue;
      }
      const Eigen::Vector3d p = mesh_.positions[v].cast<double>();
      if (std::ranges::none_of(places.about(p), [&](std::size_t r) {
            return (correction.region_mm[r] - p).norm() <= correction.reach_mm;
          })) {
        continue;
      }
      if (set_.wedge_of[v] >= 0) {
        ++of_others;
      } else {
        region.push_back(v);
      }
    }
    if (region.size() < measure_quiet_.least_vertices() && of_others > region.size()) {
      return std::unexpected("other wedges lie there: delete or split them first");
    }
    sort_by_height(&region);
    auto made = measure(region, ByHand::kAdded);
    if (!made) {
      return std::unexpected("no wedge is measured there: " + made.error());
    }
    put_in(*std::move(made));
    return {};
  }

  const Mesh& mesh_;
  const VertexGraph& graph_;
  const SurfaceFields& fields_;
  const WedgeOptions& options_;
  const WedgeFindings& findings_;
  HollowMeasure measure_quiet_;
  HollowMeasure measure_noisy_;
  std::vector<double> around_seed_mm_;  ///< of each body
  std::vector<std::int32_t> slot_;
  std::vector<WedgeCandidate> company_;  ///< all that are judged together, without their vertices
  WedgeIds& ids_;
  WedgeSet& set_;
};

}  // namespace

void correct_wedges(const Mesh& mesh, const VertexGraph& graph, const SurfaceFields& fields,
                    const WedgeOptions& options, const WedgeFindings& findings, WedgeIds* ids,
                    WedgeSet* set) {
  Corrector corrector(mesh, graph, fields, options, findings, ids, set);
  for (std::size_t k = 0; k < options.corrections.size(); ++k) {
    if (const Made made = corrector.make(options.corrections[k]); !made) {
      set->lost.push_back({k, made.error()});
    }
  }
}

}  // namespace dubsar
