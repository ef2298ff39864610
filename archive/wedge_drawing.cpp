// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/wedge_drawing.h"

#include <fmt/printf.h>

#include <algorithm>
#include <array>
#include <optional>
#include <system_error>

#include "archive/html.h"
#include "core/tablet_sides.h"
#include "core/units.h"
#include "core/wedge_length.h"
#include "formats/atomic_file.h"
#include "formats/make_folder.h"

namespace dubsar {

namespace {

constexpr double kMarginMm = 3;
constexpr double kFooterMm = 8;
constexpr double kScaleMm = 10;

/// The sheet: x to the right, y down, mm, from the upper left corner of what is drawn.
struct Sheet {
  const SideAxes& axes;
  const RigidTransform& text_from_model;
  double left = 0, top = 0, width = 0, height = 0;
  [[nodiscard]] Eigen::Vector2d at(const Eigen::Vector3d& p_model) const {
    const Eigen::Vector3d p = text_from_model * p_model;
    return {p.dot(axes.right) - left, top - p.dot(axes.up())};
  }
};

std::string name_of(ByHand by_hand) {
  return std::string(kByHandNames[static_cast<std::size_t>(by_hand)]);
}

/// For programs, as JSON: SVG 1.1 knows no data- attributes.
std::string metadata(const Wedge& w) {
  const auto directional = static_cast<std::size_t>(w.directional_edge);
  return fmt::sprintf(
      R"({"id":%d,"line":%d,"order":%d,"confidence":%.3f,"depth_mm":%.3f,"length_mm":%.3f,"turn_deg":%.1f,"volume_mm3":%.4f%s%s})",
      w.id, w.place.line, w.place.order, w.confidence, w.depth_mm, w.edge_lengths_mm[directional],
      deg_from_rad(w.place.turn_rad), w.volume_mm3,
      length_is_guess(w, directional) ? R"(,"length_beyond_mesh":true)" : "",
      w.by_hand == ByHand::kNo ? std::string() : fmt::sprintf(R"(,"by_hand":"%s")", name_of(w.by_hand)));
}

/// Where it is measured to beyond the end of the mesh it is a guess, and said to be one.
std::string length_mm(const Wedge& w, std::size_t k) {
  return fmt::sprintf("%.2f%s", w.edge_lengths_mm[k],
                      length_is_guess(w, k) ? " (the mesh ends before it)" : "");
}

std::string numbers(const Wedge& w) {
  const auto deg = [](double rad) { return deg_from_rad(rad); };
  return fmt::sprintf(
      "wedge %d, line %d, %d: depth %.2f mm, edges %s %s %s mm, face angles %.0f %.0f %.0f, opening "
      "angles %.0f %.0f %.0f degrees, confidence %.2f%s",
      w.id, w.place.line, w.place.order, w.depth_mm, length_mm(w, 0), length_mm(w, 1), length_mm(w, 2),
      deg(w.face_angles_rad[0]), deg(w.face_angles_rad[1]), deg(w.face_angles_rad[2]),
      deg(w.opening_angles_rad[0]), deg(w.opening_angles_rad[1]), deg(w.opening_angles_rad[2]), w.confidence,
      w.by_hand == ByHand::kNo ? std::string() : "; corrected by hand: " + name_of(w.by_hand));
}

std::string group(const Sheet& sheet, const Wedge& w) {
  const Eigen::Vector2d tip = sheet.at(w.depth_point_mm);
  std::array<Eigen::Vector2d, 3> corner;
  for (std::size_t k = 0; k < 3; ++k) {
    corner[k] = sheet.at(w.outer_vertices_mm[k]);
  }
  std::string out = "<g id=\"wedge-" + std::to_string(w.id) + "\" class=\"" +
                    (w.by_hand == ByHand::kNo ? "wedge" : "wedge by-hand") + "\">\n<title>" +
                    html_escaped(numbers(w)) + "</title>\n<metadata>" + metadata(w) + "</metadata>\n";
  out += fmt::sprintf("<path class=\"outer\" d=\"M%.3f %.3fL%.3f %.3fL%.3f %.3fZ\"/>\n", corner[0].x(),
                      corner[0].y(), corner[1].x(), corner[1].y(), corner[2].x(), corner[2].y());
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector2d end = sheet.at(w.exit_points_mm[k]);
    out += fmt::sprintf("<path class=\"%s\" d=\"M%.3f %.3fL%.3f %.3f\"/>\n",
                        static_cast<int>(k) == w.directional_edge ? "inner directional" : "inner", tip.x(),
                        tip.y(), end.x(), end.y());
  }
  return out + "</g>\n";
}

bool is_on(const Wedge& wedge, Face side) {
  return wedge.place.side && *wedge.place.side == side;
}

}  // namespace

namespace {

/// The tablet's rim as one path; what is a hole in it stays open by the even-odd rule.
std::string outline_path(const Sheet& sheet, const std::vector<OutlineRing>& outline) {
  std::string d;
  for (const OutlineRing& ring : outline) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      d += fmt::sprintf("%c%.3f %.3f", i == 0 ? 'M' : 'L', ring[i].x() - sheet.left, sheet.top - ring[i].y());
    }
    d += ring.empty() ? "" : "Z";
  }
  return d.empty() ? d : "<path class=\"outline\" fill-rule=\"evenodd\" d=\"" + d + "\"/>\n";
}

/// The silhouette of one side in the plane that wedges are drawn in.
std::vector<OutlineRing> side_outline(const RenderScene& scene, Face side,
                                      const RigidTransform& text_from_model) {
  constexpr int kLongestPx = 1500;
  const SideAxes& axes = side_axes(side);
  ViewCamera camera;
  camera.view_from_model.row(0) = axes.right.transpose() * text_from_model.rotation;
  camera.view_from_model.row(1) = axes.up().transpose() * text_from_model.rotation;
  camera.view_from_model.row(2) = axes.normal.transpose() * text_from_model.rotation;
  Result<std::vector<OutlineRing>> rings = outline_of(scene, camera, kLongestPx);
  if (!rings) {
    return {};  // nothing to see: the wedges are drawn without
  }
  const Eigen::Vector2d shift(text_from_model.translation_mm.dot(axes.right),
                              text_from_model.translation_mm.dot(axes.up()));
  for (OutlineRing& ring : *rings) {
    for (Eigen::Vector2d& p : ring) {
      p += shift;
    }
  }
  return std::move(*rings);
}

}  // namespace

std::string wedge_drawing(Face side, const std::vector<Wedge>& wedges, const RigidTransform& text_from_model,
                          PictureWords words, const std::vector<OutlineRing>& outline) {
  words.title.append(", ").append(to_string(side));
  Sheet sheet{side_axes(side), text_from_model};
  double left = 1e30;
  double right = -1e30;
  double low = 1e30;
  double high = -1e30;
  for (const Wedge& wedge : wedges) {
    if (!is_on(wedge, side)) {
      continue;
    }
    const auto widen = [&](const Eigen::Vector3d& p_model) {
      const Eigen::Vector2d p = sheet.at(p_model);
      left = std::min(left, p.x());
      right = std::max(right, p.x());
      low = std::min(low, -p.y());
      high = std::max(high, -p.y());
    };
    widen(wedge.depth_point_mm);
    for (std::size_t k = 0; k < 3; ++k) {
      widen(wedge.outer_vertices_mm[k]);
      widen(wedge.exit_points_mm[k]);
    }
  }
  for (const OutlineRing& ring : outline) {
    for (const Eigen::Vector2d& p : ring) {
      left = std::min(left, p.x());
      right = std::max(right, p.x());
      low = std::min(low, p.y());
      high = std::max(high, p.y());
    }
  }
  if (left > right) {
    left = right = low = high = 0;
  }
  sheet.left = left - kMarginMm;
  sheet.top = high + kMarginMm;
  sheet.width = std::max(right - left, kScaleMm) + 2 * kMarginMm;
  sheet.height = high - low + 2 * kMarginMm + kFooterMm;
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  out += fmt::sprintf(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"%.3fmm\" height=\"%.3fmm\" "
      "viewBox=\"0 0 %.3f %.3f\">\n",
      sheet.width, sheet.height, sheet.width, sheet.height);
  out += "<title>" + html_escaped(words.title) + "</title>\n<metadata>" + rdf_of(words) + "</metadata>\n";
  out +=
      "<style type=\"text/css\">.outer{fill:#e8e4dc;stroke:#000;stroke-width:.08;stroke-linejoin:round}"
      ".inner{fill:none;stroke:#000;stroke-width:.06;stroke-linecap:round}.directional{stroke-width:.16}"
      ".outline{fill:none;stroke:#000;stroke-width:.12;stroke-linejoin:round}.scale{fill:none;stroke:#000;"
      "stroke-width:.2}.by-hand .outer{fill:#d5e3f2;stroke-dasharray:.3 .15}text{font:2.2px "
      "sans-serif}</style>\n";
  out += outline_path(sheet, outline);
  for (const Wedge& wedge : wedges) {
    out += is_on(wedge, side) ? group(sheet, wedge) : std::string();
  }
  const double y = sheet.height - kFooterMm + 2;
  out += fmt::sprintf("<path class=\"scale\" d=\"M%.3f %.3fv1h%.3fv-1\"/>\n", kMarginMm, y, kScaleMm);
  out += fmt::sprintf("<text x=\"%.3f\" y=\"%.3f\">10 mm</text>\n", kMarginMm, y + 4);
  return out + "</svg>\n";
}

std::vector<WedgeDrawing> wedge_drawings(const std::filesystem::path& folder,
                                         const std::vector<Wedge>& wedges,
                                         const RigidTransform& text_from_model, const PictureWords& words,
                                         const Mesh* mesh) {
  std::optional<RenderScene> scene;
  if (mesh != nullptr) {
    scene.emplace(*mesh);
  }
  std::vector<WedgeDrawing> drawings;
  std::error_code ignored;
  for (int f = 0; f < kFaceCount; ++f) {
    const auto side = static_cast<Face>(f);
    const std::string name = std::string(to_string(side)) + ".svg";
    // One of a side that has lost its last wedge must not go on showing it.
    if (std::ranges::none_of(wedges, [&](const Wedge& w) { return is_on(w, side); }) &&
        !std::filesystem::exists(folder / name, ignored)) {
      continue;
    }
    const std::vector<OutlineRing> outline =
        scene ? side_outline(*scene, side, text_from_model) : std::vector<OutlineRing>();
    drawings.push_back({name, wedge_drawing(side, wedges, text_from_model, words, outline)});
  }
  return drawings;
}

Result<std::vector<std::filesystem::path>> write_wedge_drawings(const std::filesystem::path& folder,
                                                                const std::vector<Wedge>& wedges,
                                                                const RigidTransform& text_from_model,
                                                                const PictureWords& words, const Mesh* mesh) {
  if (const Status made = make_folder(folder); !made) {
    return std::unexpected(made.error());
  }
  std::vector<std::filesystem::path> files;
  for (const WedgeDrawing& drawing : wedge_drawings(folder, wedges, text_from_model, words, mesh)) {
    files.push_back(folder / drawing.name);
    if (const Status written = write_file_atomically(files.back(), drawing.svg); !written) {
      return std::unexpected(written.error());
    }
  }
  return files;
}

}  // namespace dubsar
