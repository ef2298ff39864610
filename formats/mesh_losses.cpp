// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/mesh_losses.h"

#include <algorithm>
#include <cstdint>
#include <span>
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
std::string listed(std::span<const std::string> names, const char* before_last) {
  std::string out;
  for (std::size_t k = 0; k < names.size(); ++k) {
    out += k == 0 ? "" : k + 1 == names.size() ? before_last : ", ";
    out += names[k];
  }
  return out;
}

/// A file may name hundreds of properties, as long as it likes.
std::vector<std::string> shortened(std::span<const std::string> names) {
  constexpr std::size_t kMostNamed = 8;
  constexpr std::size_t kMostBytes = 40;
  std::vector<std::string> out;
  for (const std::string& name : names.first(std::min(names.size(), kMostNamed))) {
    out.push_back(name.size() > kMostBytes ? name.substr(0, kMostBytes) + "..." : name);
  }
  if (names.size() > kMostNamed) {
    out.push_back(std::to_string(names.size() - kMostNamed) + " more");
  }
  return out;
}

}  // namespace

LeftOut left_out_of(const Mesh& mesh, const std::filesystem::path& file) {
  LeftOut out;
  const MeshFormat format = format_of(file);
  const bool whole_faces_alone = format == MeshFormat::kDracoGlb;
  if (!whole_faces_alone && format != MeshFormat::kStl) {
    return out;
  }
  std::vector<std::uint8_t> used(mesh.positions.size(), 0);
  for (const auto& [a, b, c] : mesh.faces) {
    if (whole_faces_alone && (a == b || b == c || c == a)) {
      ++out.faces;
    } else {
      used[a] = used[b] = used[c] = 1;
    }
  }
  out.vertices = static_cast<std::size_t>(std::ranges::count(used, 0));
  return out;
}

std::optional<Error> mesh_losses(const Mesh& mesh, const std::filesystem::path& file, const std::string& mend,
                                 std::span<const std::string> passed_over) {
  const std::string format = format_name(file);
  std::vector<std::string> lost;
  const auto lose = [&](const char* name, bool known) {
    if (known && format != "PLY") {
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
  if (lost.empty() && passed_over.empty()) {
    return std::nullopt;
  }
  std::string what = lost.empty() ? "" : format + " holds no " + listed(lost, " or ") + ": left out";
  if (!passed_over.empty()) {
    what += lost.empty() ? "" : ", and ";
    what += "what Dubsar does not read is left out: " + listed(shortened(passed_over), " and ");
  }
  return Error{ErrorKind::kBadInput, what, file.string(), mend};
}

}  // namespace dubsar
