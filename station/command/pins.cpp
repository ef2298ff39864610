// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar pins: where to put the pins round a tablet, with a picture.

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "archive/pin_layout_picture.h"
#include "archive/png.h"
#include "core/tablet_frame.h"
#include "core/units.h"
#include "formats/atomic_file.h"
#include "planning/pin_layout.h"
#include "station/command/command.h"
#include "station/command/mesh_unit.h"
#include "station/command/option_checks.h"
#include "station/command/outputs.h"
#include "station/command/size_option.h"
#include "station/outward_faces.h"

namespace dubsar {

namespace {

/// Of a tablet that is known by its size alone: edges rounded by this part of its least side.
constexpr double kEdgeRadiusShare = 0.1;

struct PinsArguments {
  std::string size;
  std::string mesh;
  std::string unit;  ///< of the mesh
  std::string out;
  int count = 15;
  double triangulation_deg = 24.0;
};

nlohmann::ordered_json triple(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

nlohmann::ordered_json layout_json(const PinLayout& layout, const std::string& warning,
                                   const std::string& unit_assumed, const PinsArguments& arguments) {
  nlohmann::ordered_json json{{"unit", "mm"},
                              {"frame", "tablet"},
                              {"size_mm", triple(layout.size_mm)},
                              {"triangulation_deg", arguments.triangulation_deg},
                              {"least_seen", layout.census.least},
                              {"mean_seen", layout.census.mean},
                              {"proven_everywhere", layout.proven},
                              {"worst_view",
                               {{"to_laser", triple(layout.census.worst.to_laser)},
                                {"to_camera", triple(layout.census.worst.to_camera)}}},
                              {"pins", nlohmann::ordered_json::array()}};
  for (const PlannedPin& pin : layout.pins) {
    json["pins"].push_back({{"label", pin.number},
                            {"rim", triple(pin.rim_mm)},
                            {"tip", triple(pin.pose.tip_mm)},
                            {"arm", triple(pin.pose.arm)}});
  }
  json["warning"] = warning.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(warning);
  if (!unit_assumed.empty()) {
    json["unit_assumed"] = unit_assumed;
  }
  if (!arguments.out.empty()) {
    json["picture"] = arguments.out;
  }
  return json;
}

Status write_picture(const PinLayout& layout, const Mesh& tablet, const PinsArguments& arguments,
                     const JobContext& job) {
  std::vector<PicturedPin> pictured;
  for (const PlannedPin& pin : layout.pins) {
    pictured.push_back({pin.number, pin.rim_mm, pin.pose.tip_mm, pin.pose.arm});
  }
  const Result<Image> image = pin_layout_picture(tablet, pictured, job);
  if (!image) {
    return std::unexpected(image.error());
  }
  const Result<std::vector<std::uint8_t>> png = encode_png(*image, "pin layout");
  if (!png) {
    return std::unexpected(png.error());
  }
  return write_file_atomically(arguments.out,
                               std::string_view(reinterpret_cast<const char*>(png->data()), png->size()));
}

Result<int> pins(const PinsArguments& arguments, CommandContext& context) {
  TabletHull hull;
  Mesh tablet;
  std::string unit_assumed;
  if (arguments.mesh.empty()) {
    const Result<Eigen::Vector3d> parsed = parse_size_mm(arguments.size);
    if (!parsed) {
      return std::unexpected(parsed.error());
    }
    const Eigen::Vector3d& size = *parsed;
    const double radius_mm = kEdgeRadiusShare * size.minCoeff();
    hull = hull_of_box(size, radius_mm);
    tablet = box_mesh(size, radius_mm);
  } else {
    Result<MeshInItsUnit> read = read_mesh_in_its_unit(arguments.mesh, arguments.unit, context.job);
    if (!read) {
      return std::unexpected(read.error());
    }
    unit_assumed = read->unit_assumed;
    tablet = std::move(read->mesh);
    face_outwards(&tablet, arguments.mesh);
    const RigidTransform tablet_from_model = tablet_frame(tablet);
    hull = hull_of_mesh(tablet, tablet_from_model);
    Eigen::AlignedBox3d box;
    for (Eigen::Vector3f& p : tablet.positions) {
      const Eigen::Vector3d q = tablet_from_model * p.cast<double>();
      p = q.cast<float>();
      if (q.allFinite()) {
        box.extend(q);
      }
    }
    for (Eigen::Vector3f& p : tablet.positions) {
      p -= box.center().cast<float>();
    }
    tablet.normals.clear();
  }
  PinLayoutOptions options;
  options.count = arguments.count;
  options.triangulation_rad = rad_from_deg(arguments.triangulation_deg);
  const Result<PinLayout> layout =
      plan_pin_layout(hull, kEdgeRadiusShare * hull.half_mm.minCoeff() * 2.0, options, context.job);
  if (!layout) {
    return std::unexpected(layout.error());
  }
  if (!arguments.out.empty()) {
    if (const Status written = write_picture(*layout, tablet, arguments, context.job); !written) {
      return std::unexpected(written.error());
    }
  }
  const std::string warning =
      layout->census.least < kFewPinsSeen
          ? fmt::format(
                "from some sides only {} pins can be seen: let scans from there overlap well, or use the "
                "surface",
                layout->census.least)
          : "";
  finish_progress();
  if (!warning.empty()) {
    std::fprintf(stderr, "warning: %s\n", warning.c_str());
  }
  if (context.json) {
    CommandContext::print(layout_json(*layout, warning, unit_assumed, arguments));
    return 0;
  }
  std::printf("at least %d of %zu pins seen from every side (%.1f on average; %d proven for every view)\n",
              layout->census.least, layout->pins.size(), layout->census.mean, layout->proven);
  for (const PlannedPin& pin : layout->pins) {
    std::printf("  pin %2d at %6.1f %6.1f %6.1f, tip %.1f mm before it\n", pin.number, pin.rim_mm.x(),
                pin.rim_mm.y(), pin.rim_mm.z(), (pin.pose.tip_mm - pin.rim_mm).norm());
  }
  return 0;
}

}  // namespace

void add_pins(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand("pins", "Where to put the pins round a tablet, with a picture");
  const auto arguments = std::make_shared<PinsArguments>();
  CLI::Option* size =
      verb->add_option("--size", arguments->size, "width x height x thickness in mm, 50x40x20");
  CLI::Option* mesh =
      verb->add_option("--mesh", arguments->mesh, "a mesh of the tablet, instead of its size");
  size->excludes(mesh);
  verb->add_option("--unit", arguments->unit,
                   "what the mesh's numbers are; default: the file's own word, else by its size")
      ->check(CLI::IsMember(std::vector<std::string>(kLengthUnits.begin(), kLengthUnits.end())))
      ->needs(mesh);
  verb->add_option("-o,--out", arguments->out, "write the picture here (PNG)")->check(ends_as(".png"));
  verb->add_option("--count", arguments->count, "pins, at most 15")
      ->check(in_range(3, 15))
      ->capture_default_str();
  verb->add_option("--triangulation", arguments->triangulation_deg,
                   "degrees between laser and camera; 0: one viewpoint")
      ->check(in_range(0.0, 80.0))
      ->capture_default_str();
  verb->fallthrough();
  verb->callback([&chosen, arguments] {
    chosen =
        with_safe_outputs({arguments->out}, [arguments](CommandContext& c) { return pins(*arguments, c); });
  });
}

}  // namespace dubsar
