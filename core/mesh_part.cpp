// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/mesh_part.h"

#include <algorithm>
#include <array>

namespace dubsar {

std::vector<IndexRange> ranges_of(std::vector<std::uint32_t> indices) {
  std::ranges::sort(indices);
  std::vector<IndexRange> out;
  for (const std::uint32_t i : indices) {
    if (!out.empty() && i - out.back().first < out.back().count) {
      continue;
    }
    if (!out.empty() && i - out.back().first == out.back().count) {
      ++out.back().count;
    } else {
      out.push_back({i, 1});
    }
  }
  return out;
}

std::vector<std::uint32_t> indices_of(const std::vector<IndexRange>& ranges) {
  std::vector<std::uint32_t> out;
  out.reserve(count_of(ranges));
  for (const IndexRange& range : ranges) {
    for (std::uint32_t k = 0; k < range.count; ++k) {
      out.push_back(range.first + k);
    }
  }
  return out;
}

std::size_t count_of(const std::vector<IndexRange>& ranges) {
  std::size_t sum = 0;
  for (const IndexRange& range : ranges) {
    sum += range.count;
  }
  return sum;
}

bool fits(const MeshSelection& selection, const Mesh& mesh) {
  const std::size_t there = selection.of == MeshElement::kFace ? mesh.faces.size() : mesh.positions.size();
  return std::ranges::all_of(selection.ranges, [there](const IndexRange& range) {
    return std::size_t{range.first} + range.count <= there;
  });
}

std::vector<std::uint8_t> selected_vertices(const Mesh& mesh, const MeshSelection& selection) {
  std::vector<std::uint8_t> out(mesh.positions.size(), 0);
  for (const IndexRange& range : selection.ranges) {
    for (std::size_t i = range.first; i < std::size_t{range.first} + range.count; ++i) {
      if (selection.of == MeshElement::kVertex) {
        out[i] = 1;
        continue;
      }
      for (const std::uint32_t v : mesh.faces[i]) {
        if (v < out.size()) {  // of a faulty face
          out[v] = 1;
        }
      }
    }
  }
  return out;
}

Mesh part_of(const Mesh& mesh, const MeshSelection& selection) {
  const std::size_t n = mesh.positions.size();
  const std::vector<std::uint8_t> taken = selected_vertices(mesh, selection);
  std::vector<std::uint32_t> number(n, 0);
  Mesh part;
  const auto carry = [n](const auto& from, auto& to, std::size_t v) {
    if (from.size() == n) {
      to.push_back(from[v]);
    }
  };
  for (std::size_t v = 0; v < n; ++v) {
    if (taken[v] == 0) {
      continue;
    }
    number[v] = static_cast<std::uint32_t>(part.positions.size());
    part.positions.push_back(mesh.positions[v]);
    carry(mesh.normals, part.normals, v);
    carry(mesh.reliability, part.reliability, v);
    carry(mesh.sigma_mm, part.sigma_mm, v);
    carry(mesh.scans, part.scans, v);
    carry(mesh.flags, part.flags, v);
    carry(mesh.colours, part.colours, v);
  }
  const auto add = [&](const std::array<std::uint32_t, 3>& face) {
    if (std::ranges::all_of(face, [&](std::uint32_t v) { return v < n && taken[v] != 0; })) {
      part.faces.push_back({number[face[0]], number[face[1]], number[face[2]]});
    }
  };
  if (selection.of == MeshElement::kVertex) {
    std::ranges::for_each(mesh.faces, add);
  } else {
    for (const std::uint32_t f : indices_of(selection.ranges)) {
      add(mesh.faces[f]);
    }
  }
  return part;
}

}  // namespace dubsar
