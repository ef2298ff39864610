// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/ply_passed_over.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "formats/colour_values.h"
#include "formats/mesh_formats.h"

namespace dubsar {

namespace {

constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kTexturePlaces{
    {{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}}};

bool is_texture_place(const PlyElement& vertex, std::string_view property) {
  return std::ranges::any_of(kTexturePlaces, [&](const auto& pair) {
    return (property == pair.first || property == pair.second) && vertex.scalar(pair.first) >= 0 &&
           vertex.scalar(pair.second) >= 0;
  });
}

bool is_vertex_list(const PlyProperty& property) {
  return property.count_type && (property.name == "vertex_indices" || property.name == "vertex_index");
}

/// 1 for each property of the vertices that the mesh has a place for.
std::vector<std::uint8_t> known_properties(const PlyElement& vertex) {
  std::vector<std::uint8_t> known(vertex.properties.size(), 0);
  const auto mark = [&](int property) {
    if (property >= 0) {
      known[static_cast<std::size_t>(property)] = 1;
    }
  };
  const auto mark_all = [&](const std::array<int, 3>& three) {
    if (std::ranges::all_of(three, [](int p) { return p >= 0; })) {
      std::ranges::for_each(three, mark);
    }
  };
  for (const char* name : {"x", "y", "z", "reliability", "sigma", "scans"}) {
    mark(vertex.scalar(name));
  }
  mark(marks_property(vertex));
  mark_all({vertex.scalar("nx"), vertex.scalar("ny"), vertex.scalar("nz")});
  mark_all(PlyColours::properties_of(vertex));
  return known;
}

}  // namespace

int marks_property(const PlyElement& vertex) {
  const int flags = vertex.scalar("flags");
  const bool ours = flags >= 0 && vertex.properties[static_cast<std::size_t>(flags)].type == PlyType::kUint8;
  return ours ? flags : -1;
}

bool has_texture_places(const PlyElement& vertex) {
  return std::ranges::any_of(vertex.properties, [&](const PlyProperty& property) {
    return is_texture_place(vertex, property.name);
  });
}

std::vector<std::string> passed_over_of_mesh(const PlyHeader& header) {
  std::vector<std::string> names;
  const auto name_once = [&](std::string name) {
    if (std::ranges::find(names, name) == names.end()) {
      names.push_back(std::move(name));
    }
  };
  for (const PlyElement& element : header.elements) {
    if (element.count == 0) {
      continue;
    }
    if (element.name == "vertex") {
      const std::vector<std::uint8_t> known = known_properties(element);
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        const bool of_texture = is_texture_place(element, property.name);
        if (known[p] == 0) {
          name_once(of_texture ? kTextureCoordinates : "vertex " + property.name);
        }
      }
    } else if (element.name == "face" || element.name == "tristrips") {
      for (const PlyProperty& property : element.properties) {
        if (!is_vertex_list(property)) {
          name_once(property.name == "texcoord" ? kTextureCoordinates : "face " + property.name);
        }
      }
    } else {
      name_once(element.name);
    }
  }
  return names;
}

}  // namespace dubsar
