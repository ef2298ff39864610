// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/front.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/parallel_sort.h"
#include "core/units.h"

namespace dubsar {

namespace {

void take_out(std::vector<std::uint32_t>& values, std::uint32_t value) {
  const auto at = std::find(values.begin(), values.end(), value);
  if (at != values.end()) {
    values.erase(at);
  }
}

}  // namespace

void HalfEdgeSet::reserve(std::size_t count) {
  std::size_t size = std::max<std::size_t>(slots_.size(), 16);
  while (size < 2 * count) {
    size *= 2;
  }
  if (size == slots_.size()) {
    return;
  }
  std::vector<std::uint64_t> old(size, kEmpty);
  old.swap(slots_);
  for (const std::uint64_t key : old) {
    if (key != kEmpty) {
      slots_[slot_of(key)] = key;
    }
  }
}

bool HalfEdgeSet::insert(std::uint32_t a, std::uint32_t b) {
  reserve(count_ + 1);
  std::uint64_t& slot = slots_[slot_of(key_of(a, b))];
  if (slot != kEmpty) {
    return false;
  }
  slot = key_of(a, b);
  ++count_;
  return true;
}

Front::Front(Sheet& sheet) : sheet_(&sheet), link_of_(sheet.positions.size(), kNone) {
  float coarsest = 0;
  for (const float mu : sheet.spacing_mm) {
    coarsest = std::max(coarsest, mu);
  }
  // Twice the radius that seams look around with: a query meets 8 buckets, seldom more.
  cells_per_mm_ = coarsest > 0 ? 1.0F / (6.6F * coarsest) : 1.0F;
  buckets_.resize(1U << 10U);
  const std::vector<std::uint8_t> rim = rim_vertices(sheet.faces, sheet.positions.size());
  const HalfEdges edges(sheet.faces, sheet.positions.size(), rim);
  const auto each_rim_edge = [&](const auto& visit) {
    for (const Triangle& f : sheet.faces) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (rim[f[k]] != 0 && rim[f[(k + 1) % 3]] != 0) {
          visit(f[k], f[(k + 1) % 3]);
        }
      }
    }
  };
  std::size_t inner = 0;
  std::vector<Edge> open;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> places;  // bucket, vertex
  each_rim_edge([&](std::uint32_t a, std::uint32_t b) {
    ++inner;
    const bool known = sheet.whole.empty() || (sheet.whole[a] | sheet.whole[b]) != 0;
    if (known && edges.face(b, a) < 0) {
      open.push_back({a, b});
      places.emplace_back(key_of(cell_of(sheet.positions[a])), a);
      places.emplace_back(key_of(cell_of(sheet.positions[b])), b);
    }
  });
  // What lies near in space lies near in memory.
  parallel_sort(places.begin(), places.end(), std::less<>{});
  for (const auto& [key, v] : places) {
    links(v);
  }
  for (const Edge& edge : open) {
    links(edge.a).out.push_back(edge.b);
    links(edge.b).in.push_back(edge.a);
  }
  half_edges_.reserve(2 * inner);
  each_rim_edge([&](std::uint32_t a, std::uint32_t b) { half_edges_.insert(a, b); });
}

Front::Cell Front::cell_of(const Eigen::Vector3f& p) const {
  const auto cell = [&](float x) {
    const float at = std::clamp(x * cells_per_mm_, -1.0e6F, 1.0e6F);
    const auto towards_zero = static_cast<int>(at);
    return towards_zero - (at < static_cast<float>(towards_zero) ? 1 : 0);
  };
  return {cell(p.x()), cell(p.y()), cell(p.z())};
}

std::uint64_t Front::key_of(const Cell& cell) {
  const auto part = [](int c) { return static_cast<std::uint64_t>(c + (1 << 20)) & 0x1fffffU; };
  return (part(cell[0]) << 42U) | (part(cell[1]) << 21U) | part(cell[2]);
}

std::size_t Front::slot_of(const Cell& cell, std::uint64_t& key) const {
  key = key_of(cell);
  std::uint64_t mixed = key * 0x9e3779b97f4a7c15ULL;
  mixed ^= mixed >> 32U;
  std::size_t slot = mixed & (buckets_.size() - 1);
  while (buckets_[slot].first != kNone && buckets_[slot].key != key) {
    slot = (slot + 1) & (buckets_.size() - 1);
  }
  return slot;
}

void Front::grow_buckets() {
  std::vector<Bucket> old(2 * buckets_.size());
  old.swap(buckets_);
  for (const Bucket& bucket : old) {
    if (bucket.first != kNone) {
      std::uint64_t key = 0;
      const std::size_t slot = slot_of(cell_of(links_[bucket.first].position), key);
      buckets_[slot] = bucket;
    }
  }
}

Front::Links& Front::links(std::uint32_t v) {
  if (link_of_[v] == kNone) {
    if (2 * (links_.size() + 1) > buckets_.size()) {
      grow_buckets();
    }
    link_of_[v] = static_cast<std::uint32_t>(links_.size());
    Links& added = links_.emplace_back();
    added.vertex = v;
    added.position = sheet_->positions[v];
    added.normal = sheet_->normals[v];
    std::uint64_t key = 0;
    Bucket& bucket = buckets_[slot_of(cell_of(added.position), key)];
    added.next_in_bucket = bucket.first;
    bucket.key = key;
    bucket.first = link_of_[v];
  }
  return links_[link_of_[v]];
}

const Front::Links* Front::find(std::uint32_t v) const {
  return link_of_[v] == kNone ? nullptr : &links_[link_of_[v]];
}

std::vector<Front::Edge> Front::open_edges() const {
  std::vector<Edge> out;
  for (const Links& l : links_) {
    for (const std::uint32_t b : l.out) {
      out.push_back({l.vertex, b});
    }
  }
  return out;
}

bool Front::is_open(std::uint32_t a, std::uint32_t b) const {
  const Links* l = find(a);
  return l != nullptr && std::find(l->out.begin(), l->out.end(), b) != l->out.end();
}

bool Front::on_front(std::uint32_t v) const {
  const Links* l = find(v);
  return l != nullptr && (l->free || !l->out.empty());
}

std::span<const std::uint32_t> Front::out_of(std::uint32_t v) const {
  const Links* l = find(v);
  return l == nullptr ? std::span<const std::uint32_t>{} : l->out;
}

std::span<const std::uint32_t> Front::into(std::uint32_t v) const {
  const Links* l = find(v);
  return l == nullptr ? std::span<const std::uint32_t>{} : l->in;
}

bool Front::accepts(const Triangle& f) const {
  return f[0] != f[1] && f[1] != f[2] && f[2] != f[0] && !half_edges_.contains(f[0], f[1]) &&
         !half_edges_.contains(f[1], f[2]) && !half_edges_.contains(f[2], f[0]);
}

void Front::add_face(const Triangle& f) {
  sheet_->faces.push_back(f);
  ++changes_;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t a = f[k];
    const std::uint32_t b = f[(k + 1) % 3];
    half_edges_.insert(a, b);
    links(a).free = false;
    std::uint64_t key = 0;
    buckets_[slot_of(cell_of(sheet_->positions[a]), key)].changed = changes_;
    if (half_edges_.contains(b, a)) {
      take_out(links(b).out, a);
      take_out(links(a).in, b);
    } else {
      links(a).out.push_back(b);
      links(b).in.push_back(a);
    }
  }
}

std::uint32_t Front::add_vertex(const Eigen::Vector3f& position_mm, const Eigen::Vector3f& normal,
                                float spacing_mm, float sigma_mm) {
  const auto v = static_cast<std::uint32_t>(sheet_->positions.size());
  sheet_->positions.push_back(position_mm);
  sheet_->normals.push_back(normal);
  sheet_->spacing_mm.push_back(spacing_mm);
  sheet_->sigma_mm.push_back(sigma_mm);
  if (!sheet_->whole.empty()) {
    sheet_->whole.push_back(1);
  }
  link_of_.push_back(kNone);
  links(v).free = true;
  return v;
}

std::size_t Front::last_change(const Eigen::AlignedBox3f& box) const {
  std::size_t last = 0;
  const Cell low = cell_of(box.min());
  const Cell high = cell_of(box.max());
  for (int u = low[0]; u <= high[0]; ++u) {
    for (int v = low[1]; v <= high[1]; ++v) {
      for (int w = low[2]; w <= high[2]; ++w) {
        std::uint64_t key = 0;
        const Bucket& bucket = buckets_[slot_of({u, v, w}, key)];
        last = bucket.first != kNone ? std::max(last, bucket.changed) : last;
      }
    }
  }
  return last;
}

bool Front::near(const Eigen::Vector3f& p_mm, float radius_mm, std::vector<const Links*>& out) const {
  out.clear();
  const Eigen::Vector3f reach = Eigen::Vector3f::Constant(radius_mm);
  const Cell low = cell_of(p_mm - reach);
  const Cell high = cell_of(p_mm + reach);
  std::size_t met = 0;
  for (int u = low[0]; u <= high[0]; ++u) {
    for (int v = low[1]; v <= high[1]; ++v) {
      for (int w = low[2]; w <= high[2]; ++w) {
        std::uint64_t key = 0;
        for (std::uint32_t l = buckets_[slot_of({u, v, w}, key)].first; l != kNone;
             l = links_[l].next_in_bucket) {
          const Links& link = links_[l];
          if (++met > kMostMet) {
            return false;
          }
          if ((link.position - p_mm).squaredNorm() <= radius_mm * radius_mm &&
              (link.free || !link.out.empty())) {
            out.push_back(&link);
          }
        }
      }
    }
  }
  return true;
}

std::vector<Front::Walk> Front::walks() const {
  std::vector<Walk> all;
  HalfEdgeSet walked;
  for (const Edge& first : open_edges()) {
    if (walked.contains(first.a, first.b)) {
      continue;
    }
    Walk walk;
    Edge at = first;
    while (walked.insert(at.a, at.b)) {
      walk.vertices.push_back(at.a);
      const auto outs = out_of(at.b);
      std::uint32_t next = kNone;
      if (outs.size() == 1) {
        next = outs[0];
      } else {
        // The opening lies to the right of a→b: turn counter-clockwise from b→a until an open edge leaves.
        const Eigen::Vector3f& n = sheet_->normals[at.b];
        const Eigen::Vector3f back = sheet_->positions[at.a] - sheet_->positions[at.b];
        const Eigen::Vector3f side = n.cross(back);
        double least = std::numeric_limits<double>::max();
        for (const std::uint32_t head : outs) {
          if (walked.contains(at.b, head)) {
            continue;
          }
          const Eigen::Vector3f d = sheet_->positions[head] - sheet_->positions[at.b];
          double angle = std::atan2(d.dot(side), d.dot(back));
          angle = angle <= 0 ? angle + 2 * kPi : angle;
          if (angle < least) {
            least = angle;
            next = head;
          }
        }
      }
      if (next == kNone) {
        walk.leaves = !sheet_->whole.empty() && sheet_->whole[at.b] == 0;
        break;
      }
      at = {at.b, next};
    }
    all.push_back(std::move(walk));
  }
  return all;
}

std::vector<std::vector<std::uint32_t>> Front::openings() const {
  std::vector<std::vector<std::uint32_t>> loops;
  for (Walk& walk : walks()) {
    if (!walk.leaves) {
      loops.push_back(std::move(walk.vertices));
    }
  }
  return loops;
}

}  // namespace dubsar
