// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/mesh_bodies.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <tuple>
#include <unordered_map>

namespace dubsar {
namespace {

/// Of the whole area; what is smaller is a scrap.
constexpr double kLeastBody = 0.05;
/// Length of Σ area·normal, of Σ area: 0 for a closed surface, 1 for a sheet. A tablet of 50 × 40 × 20 mm
/// that lacks its reverse has 0.36.
constexpr double kOpen = 0.25;
constexpr double kNearMm = 3.0;
/// Cosine: two open parts that look the same way are no two sides of one tablet.
constexpr double kSameWay = 0.5;
constexpr std::size_t kMostBodies = 255;

struct Part {
  double area = 0;
  Eigen::Vector3d normals{0, 0, 0};
  Eigen::AlignedBox3d box;
  std::size_t body = 0;
  [[nodiscard]] bool is_open() const { return normals.norm() > kOpen * area; }
};

bool go_together(const Part& a, const Part& b) {
  const bool near = a.box.exteriorDistance(b.box) < kNearMm;
  if (!a.is_open() || !b.is_open()) {
    return near && (a.is_open() || b.is_open());
  }
  return near || a.normals.normalized().dot(b.normals.normalized()) < kSameWay;
}

std::size_t nearest_to(const Eigen::Vector3d& p, const std::vector<Part>& parts) {
  const auto nearest = std::ranges::min_element(
      parts, {}, [&](const Part& part) { return part.box.squaredExteriorDistance(p); });
  return nearest->body;
}

/// Numbers of the bodies of the parts, 0 to the count returned.
std::size_t number_bodies(std::vector<Part>* parts) {
  std::vector<Part>& all = *parts;
  std::vector<std::size_t> group(all.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  for (std::size_t a = 0; a < all.size(); ++a) {
    for (std::size_t b = a + 1; b < all.size(); ++b) {
      if (group[a] != group[b] && go_together(all[a], all[b])) {
        std::ranges::replace(group, group[b], group[a]);
      }
    }
  }
  std::unordered_map<std::size_t, Part> whole;  // by group
  for (std::size_t k = 0; k < all.size(); ++k) {
    whole[group[k]].area += all[k].area;
    whole[group[k]].box.extend(all[k].box);
  }
  std::vector<std::size_t> order;
  for (const auto& [id, part] : whole) {
    order.push_back(id);
  }
  const auto place = [&](std::size_t id) {
    const Part& part = whole.at(id);
    const Eigen::Vector3d& low = part.box.min();
    return std::tuple(-part.area, low.x(), low.y(), low.z(), id);
  };
  std::ranges::sort(order, {}, place);
  for (std::size_t k = 0; k < all.size(); ++k) {
    all[k].body = static_cast<std::size_t>(std::ranges::find(order, group[k]) - order.begin());
  }
  return order.size();
}

}  // namespace

MeshBodies find_bodies(const Mesh& mesh, const VertexGeometry& geometry) {
  MeshBodies bodies;
  const std::vector<std::uint32_t> large = geometry.parts.larger_than(kLeastBody);
  if (large.size() < 2) {
    return bodies;
  }
  std::unordered_map<std::uint32_t, std::size_t> number;
  for (const std::uint32_t part : large) {
    number.emplace(part, number.size());
  }
  std::vector<Part> parts(large.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const auto found = number.find(geometry.parts.of[v]);
    if (found != number.end() && geometry.area_mm2[v] > 0) {
      Part& part = parts[found->second];
      part.area += geometry.area_mm2[v];
      part.normals += (geometry.area_mm2[v] * geometry.normal[v]).cast<double>();
      part.box.extend(mesh.positions[v].cast<double>());
    }
  }
  const std::size_t count = number_bodies(&parts);
  if (count < 2 || count > kMostBodies) {
    return bodies;
  }
  bodies.count = count;
  bodies.of.resize(mesh.positions.size());
  std::unordered_map<std::uint32_t, std::size_t> scraps;  // by their least vertex
  for (std::uint32_t v = 0; v < bodies.of.size(); ++v) {
    const std::uint32_t part = geometry.parts.of[v];
    const auto found = number.find(part);
    std::size_t body = 0;
    if (found != number.end()) {
      body = parts[found->second].body;
    } else if (mesh.positions[part].allFinite()) {
      const auto [scrap, fresh] = scraps.try_emplace(part, 0);
      if (fresh) {
        scrap->second = nearest_to(mesh.positions[part].cast<double>(), parts);
      }
      body = scrap->second;
    }
    bodies.of[v] = static_cast<std::uint8_t>(body);
  }
  return bodies;
}

BodyMesh body_mesh(const Mesh& mesh, const std::vector<std::uint8_t>& of, std::size_t body) {
  BodyMesh out;
  std::vector<std::uint32_t> place(of.size(), 0);
  for (std::uint32_t v = 0; v < of.size(); ++v) {
    if (of[v] == body) {
      place[v] = static_cast<std::uint32_t>(out.vertex.size());
      out.vertex.push_back(v);
      out.mesh.positions.push_back(mesh.positions[v]);
      if (!mesh.reliability.empty()) {
        out.mesh.reliability.push_back(mesh.reliability[v]);
      }
    }
  }
  for (const auto& face : mesh.faces) {
    if (std::ranges::all_of(face, [&](std::uint32_t v) { return v < of.size() && of[v] == body; })) {
      out.mesh.faces.push_back({place[face[0]], place[face[1]], place[face[2]]});
    }
  }
  return out;
}

void add_times(const StageTimes& some, StageTimes* all) {
  if (all == nullptr) {
    return;
  }
  for (const StageTiming& one : some) {
    const auto known = std::ranges::find(*all, one.stage, &StageTiming::stage);
    if (known == all->end()) {
      all->push_back(one);
    } else {
      known->seconds += one.seconds;
    }
  }
}

}  // namespace dubsar
