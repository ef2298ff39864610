// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar simulate tablet | scans: test pieces whose truth is known.

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "analysis/tablet_size.h"
#include "core/mesh_query.h"
#include "core/units.h"
#include "formats/grid_ply.h"
#include "formats/make_folder.h"
#include "formats/mesh_io.h"
#include "formats/pins_json.h"
#include "formats/poses_json.h"
#include "formats/truth_json.h"
#include "sim/pins.h"
#include "sim/scan_plan.h"
#include "sim/scanner.h"
#include "sim/tablet.h"
#include "station/command/command.h"
#include "station/command/option_checks.h"
#include "station/command/outputs.h"
#include "station/command/simulate_rig.h"
#include "station/command/size_option.h"
#include "station/tablet_file.h"
#include "station/tablet_label.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

struct SimulateOptions {
  std::uint64_t seed = 1;
  std::string size = "50x40x20";
  double spacing_mm = 0.1;
  double text = 1.0;
  double damage = 0.3;
  double holes = 0;
  std::string out;
  std::string tablet;
  int views = 12;
  double noise_mm = 0.02;
  bool pins = false;
  std::string unit;
};

Result<int> simulate_tablet(const SimulateOptions& options, CommandContext& context) {
  const Result<Eigen::Vector3d> size = parse_size_mm(options.size);
  if (!size) {
    return std::unexpected(size.error());
  }
  sim::TabletOptions tablet_options;
  tablet_options.seed = options.seed;
  tablet_options.size_mm = *size;
  tablet_options.spacing_mm = options.spacing_mm;
  tablet_options.text_density = options.text;
  tablet_options.damage = {options.damage, options.damage, options.damage, options.damage, options.holes};
  const Result<sim::SimTablet> tablet = sim::make_tablet(tablet_options, context.job);
  if (!tablet) {
    return std::unexpected(tablet.error());
  }
  if (const Status made = make_folder(options.out); !made) {
    return std::unexpected(made.error());
  }
  const fs::path mesh_file = fs::path(options.out) / "tablet.ply";
  const fs::path truth_file = fs::path(options.out) / "truth.json";
  if (const Status written = write_tablet_file(mesh_file, *tablet); !written) {
    return std::unexpected(written.error());
  }
  const TabletTruth truth{"tablet.ply", options.seed, *size, options.spacing_mm, tablet->wedges};
  if (const Status written = write_truth(truth_file, truth); !written) {
    return std::unexpected(written.error());
  }
  if (context.json) {
    CommandContext::print({{"tablet", mesh_file.string()},
                           {"truth", truth_file.string()},
                           {"vertices", tablet->mesh.positions.size()},
                           {"faces", tablet->mesh.faces.size()},
                           {"wedges", tablet->wedges.size()}});
  } else {
    finish_progress();
    std::printf("%s: %zu faces, %zu wedges; truth in %s\n", mesh_file.c_str(), tablet->mesh.faces.size(),
                tablet->wedges.size(), truth_file.c_str());
  }
  return 0;
}

constexpr std::size_t kMostViews = 1000;

/// Above this a scan takes gigabytes.
constexpr double kMostSamples = 5e7;

/// A tablet whose unit is taken wrongly would take all memory there is.
Status check_scan_size(const SimulateOptions& options, const sim::SimTablet& tablet) {
  const double across_mm = size_across_mm(tablet.mesh);
  const double samples = std::pow(across_mm / options.spacing_mm, 2);
  if (samples <= kMostSamples) {
    return {};
  }
  return bad_input(
      options.tablet,
      fmt::format("it is {:.3g} mm across: at a spacing of {:.3g} mm a scan would have {:.2g} samples",
                  across_mm, options.spacing_mm, samples),
      fmt::format("say what its numbers are with --unit, or give --spacing {:.2g} or more",
                  1.05 * across_mm / std::sqrt(kMostSamples)));
}

fs::path scan_name(std::size_t k) {
  return fmt::format("scan_{:03}.ply", k);
}

/// What an earlier run with more views left would be taken for scans of this tablet.
Status check_no_scan_stays(const SimulateOptions& options) {
  for (auto k = static_cast<std::size_t>(options.views); k < kMostViews; ++k) {
    const fs::path scan = fs::path(options.out) / scan_name(k);
    std::error_code ignored;
    if (fs::exists(scan, ignored)) {
      return fail(ErrorKind::kUsage,
                  fmt::format("a scan of an earlier run lies there, and would be taken for one of these {}",
                              options.views),
                  scan.string(), "choose another folder, or take the earlier scans away");
    }
  }
  return {};
}

Result<int> simulate_scans(const SimulateOptions& options, CommandContext& context) {
  if (const Status alone = check_no_scan_stays(options); !alone) {
    return std::unexpected(alone.error());
  }
  const Result<sim::SimTablet> tablet = read_tablet_file(
      options.tablet, {.mm_per_unit = options.unit.empty() ? std::nullopt : mm_per_unit(options.unit)});
  if (!tablet) {
    return std::unexpected(tablet.error());
  }
  if (const Status size = check_scan_size(options, *tablet); !size) {
    return std::unexpected(size.error());
  }
  if (const Status made = make_folder(options.out); !made) {
    return std::unexpected(made.error());
  }
  const fs::path truth_file = fs::path(options.out) / "truth_poses.json";
  std::error_code ignored;
  fs::remove(truth_file, ignored);  // of an earlier run: it is no truth about the first new scan
  const MeshQuery query(tablet->mesh);
  sim::ScannerOptions scanner_options;
  scanner_options.spacing_mm = options.spacing_mm;
  scanner_options.noise_mm = options.noise_mm;
  scanner_options.seed = options.seed;
  const sim::TriangulationScanner scanner = sim::TriangulationScanner(fitted_to(scanner_options, *tablet));
  std::optional<sim::PinStand> stand;
  sim::PinOptions pin_options;
  pin_options.seed = options.seed;
  if (options.pins) {
    stand.emplace(*tablet, query, pin_options);
  }
  PinSet clicked{pin_options.tip_diameter_mm, {}};
  PinSet true_tips{pin_options.tip_diameter_mm, {}};
  std::vector<ScanPose> truth;
  const std::vector<sim::PlannedView> views = sim::plan_views(options.views, options.seed);
  for (std::size_t k = 0; k < views.size(); ++k) {
    context.job.progress("scanning", static_cast<double>(k) / static_cast<double>(views.size()));
    sim::Scene scene{&*tablet, &query, {}, std::nullopt};
    const int id = static_cast<int>(k);
    if (stand) {
      scene.pins = sim::standing_pins(stand->placed(id), scene, scanner, views[k].tablet_from_scanner);
      true_tips.tips[id] = sim::tips_in_scanner(scene.pins, views[k].tablet_from_scanner);
      clicked.tips[id] = sim::clicked_tips(true_tips.tips[id], 1.0, options.seed + k);
    }
    Result<RangeGrid> grid = scanner.scan_grid(scene, views[k].tablet_from_scanner, k, context.job);
    if (!grid && grid.error().kind == ErrorKind::kCancelled) {
      return fail(ErrorKind::kCancelled, "stopped before all scans were made", options.out,
                  fmt::format("{} of {} are there, without truth_poses.json; the same command makes all",
                              truth.size(), views.size()));
    }
    if (!grid) {
      return std::unexpected(grid.error());
    }
    grid->pin_tip_diameter_mm = stand ? pin_options.tip_diameter_mm : 0;
    const fs::path name = scan_name(k);
    if (const Status written =
            write_grid_ply(fs::path(options.out) / name, *grid, {.label = made_up_label()});
        !written) {
      return std::unexpected(written.error());
    }
    ScanPose pose;
    pose.id = id;
    pose.file = name.string();
    pose.model_from_scanner = views[k].tablet_from_scanner;
    pose.status = PoseStatus::kRegistered;
    pose.overlap = 1;
    truth.push_back(pose);
  }
  context.job.progress("scanning", 1.0);
  if (const Status written = write_poses(truth_file, truth); !written) {
    return std::unexpected(written.error());
  }
  if (stand) {
    for (const auto& [name, pins] :
         {std::pair{"pins.json", &clicked}, std::pair{"truth_pins.json", &true_tips}}) {
      if (const Status written = write_pins(fs::path(options.out) / name, *pins); !written) {
        return std::unexpected(written.error());
      }
    }
  }
  if (context.json) {
    nlohmann::ordered_json files = nlohmann::ordered_json::array();
    for (const ScanPose& pose : truth) {
      files.push_back(pose.file);
    }
    CommandContext::print({{"folder", options.out}, {"scans", files}, {"truth", truth_file.string()}});
  } else {
    finish_progress();
    std::printf("%zu scans in %s; truth in %s\n", truth.size(), options.out.c_str(), truth_file.c_str());
  }
  return 0;
}

}  // namespace

void add_simulate(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand("simulate", "Tablets and scans whose truth is known");
  verb->require_subcommand(1);
  verb->fallthrough();
  const auto options = std::make_shared<SimulateOptions>();

  CLI::App* tablet = verb->add_subcommand("tablet", "A procedural tablet: tablet.ply and truth.json");
  tablet->add_option("--size", options->size, "width x height x thickness, mm")->capture_default_str();
  tablet->add_option("--text", options->text, "share of the room for text that is written on")
      ->check(in_range(0.0, 1.0))
      ->capture_default_str();
  tablet->add_option("--holes", options->holes, "firing holes, 0 none to 1 many")
      ->check(in_range(0.0, 1.0))
      ->capture_default_str();
  tablet->add_option("--damage", options->damage, "fractures, erosion, dirt and cracks, 0 none to 1 badly")
      ->check(in_range(0.0, 1.0))
      ->capture_default_str();
  tablet->callback([&chosen, options] {
    chosen = with_safe_outputs({as_folder(options->out)},
                               [options](CommandContext& c) { return simulate_tablet(*options, c); });
  });

  CLI::App* scans =
      verb->add_subcommand("scans", "Range grids of a tablet: scan_000.ply … and truth_poses.json");
  scans->add_option("--tablet", options->tablet, "the true surface, a mesh")->required();
  scans
      ->add_option("--unit", options->unit,
                   "what the mesh's numbers are; default: the file's own word, else mm")
      ->check(CLI::IsMember(std::vector<std::string>(kLengthUnits.begin(), kLengthUnits.end())));
  scans->add_option("--views", options->views, "how many, turned by hand")
      ->check(in_range(1, static_cast<int>(kMostViews)))
      ->capture_default_str();
  scans->add_option("--noise", options->noise_mm, "mm, at normal incidence")
      ->check(in_range(0.0, 1.0))
      ->capture_default_str();
  scans->add_flag("--pins", options->pins,
                  "fifteen pins around the rim; writes pins.json, as an operator clicks them");
  scans->callback([&chosen, options] {
    chosen = with_safe_outputs({as_folder(options->out)},
                               [options](CommandContext& c) { return simulate_scans(*options, c); });
  });

  add_simulate_rig(*verb, chosen);

  for (CLI::App* sub : {tablet, scans}) {
    sub->add_option("--seed", options->seed, "the same seed gives the same bytes")
        ->check(not_negative())
        ->capture_default_str();
    sub->add_option("--spacing", options->spacing_mm, "mm")
        ->check(in_range(0.005, 5.0))
        ->capture_default_str();
    sub->add_option("-o,--out", options->out, "folder")->required();
    sub->fallthrough();
  }
}

}  // namespace dubsar
