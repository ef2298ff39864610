// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/mesh_losses.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "formats/mesh_formats.h"

namespace dubsar {

namespace {

/// "STL" of tablet.stl
std::string format_name(const std::filesystem::path& file) {
  std::string name = file.extension().string();
  name.erase(0, 1);
  std::ranges::transform(name, name.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - ('a' - 'A')) : c;
  });
  return name;
}

/// "scans", "scans or flags", "sigma, scans or flags"
std::string alternatives(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t k = 0; k < names.size(); ++k) {
    out += k == 0 ? "" : k + 1 == names.size() ? " or " : ", ";
    out += names[k];
  }
  return out;
}

}  // namespace

LeftOut left_out_of(const Mesh& mesh, const std::filesystem::path& file) {
  LeftOut out;
  if (format_of(file) != MeshFormat::kDracoGlb) {
    return out;
  }
  std::vector<std::uint8_t> used(mesh.positions.size(), 0);
  for (const auto& [a, b, c] : mesh.faces) {
    if (a == b || b == c || c == a) {
      ++out.faces;
    } else {
      used[a] = used[b] = used[c] = 1;
    }
  }
  out.vertices = static_cast<std::size_t>(std::ranges::count(used, 0));
  return out;
}

std::optional<Error> mesh_losses(const Mesh& mesh, const std::filesystem::path& file,
                                 const std::string& mend) {
  const std::string format = format_name(file);
  if (format == "PLY") {
    return std::nullopt;
  }
  std::vector<std::string> lost;
  const auto lose = [&](const char* name, bool known) {
    if (known) {
      lost.emplace_back(name);
    }
  };
  lose("reliability", !mesh.reliability.empty());
  lose("sigma", !mesh.sigma_mm.empty());
  lose("scans", !mesh.scans.empty());
  lose("flags", !mesh.flags.empty());
  lose("colours", !mesh.colours.empty() && format == "STL");
  const LeftOut out = left_out_of(mesh, file);
  if (out.vertices > 0) {
    lost.push_back("vertices without a face (" + std::to_string(out.vertices) + ")");
  }
  if (out.faces > 0) {
    lost.push_back("faces without three different corners (" + std::to_string(out.faces) + ")");
  }
  if (lost.empty()) {
    return std::nullopt;
  }
  return Error{ErrorKind::kBadInput, format + " holds no " + alternatives(lost) + ": left out", file.string(),
               mend};
}

}  // namespace dubsar
