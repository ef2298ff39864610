// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// Planning in a closed loop over many simulated tablets of different shape and damage: scanned, flagged,
// cleared and planned until the red map is conclusive. Is the verdict true, are the excuses, how many scans
// against a greedy set cover that knows the surface and two plain planners, and is the gain as predicted?
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/support/closed_loop.h"
#include "bench/support/options.h"
#include "bench/support/statistics.h"
#include "bench/support/true_scans.h"
#include "bench/support/view_baselines.h"
#include "core/random.h"
#include "core/stage_times.h"
#include "planning/clusters.h"
#include "planning/red_change.h"
#include "planning/surface_cover.h"

namespace {

using namespace dubsar;
using namespace dubsar::bench;

struct Arguments {
  int tablets = 10;
  std::uint64_t first = 1;
  double spacing_mm = 0.1;
  double noise_mm = 0.02;
  int max_scans = 60;
  bool registered = false;
  bool baselines = false;
  bool holes = false;
  double hole_radius_mm = 0;
  double hole_depth_mm = 0;
  double crack_depth_mm = 0;
  std::string size;
  bool verbose = false;
};

/// A scan farther off is in the wrong place, not roughly in the right one.
constexpr double kMisplacedMm = 0.1;

struct Gain {
  double predicted = 0;
  double actual = 0;
  double share = 0;  ///< of the tablet's surface
};

struct TabletResult {
  bool conclusive = false;
  int scans = 0;
  int scans_to_999 = 0;  ///< until 99.9 % of what was sampled in the end
  TabletTruth::Share share;
  double share_sampled = 0;  ///< of all
  double area_mm2 = 0;
  double red_mm2 = 0;  ///< left in the end
  double worst_pose_mm = 0;
  ExcuseScore excuses;
  std::vector<Gain> gains;
};

double red_area(const RedTargets& red) {
  double area = 0;
  for (const RedTarget& t : red.targets) {
    area += t.state == RegionState::kRed ? t.area_mm2 : 0.0;
  }
  return area;
}

/// Tablets of 20 to 50 mm, from whole to badly damaged.
LoopOptions loop_options(std::uint64_t seed, const Arguments& args) {
  LoopOptions options;
  options.tablet = random_tablet(seed, "text", std::max(0.05, 0.6 * args.spacing_mm));
  if (Eigen::Vector3d& size = options.tablet.size_mm;
      !args.size.empty() &&
      std::sscanf(args.size.c_str(), "%lfx%lfx%lf", &size.x(), &size.y(), &size.z()) != 3) {
    std::fprintf(stderr, "--size %s: width x height x thickness in mm, as in 30x25x14\n", args.size.c_str());
    std::exit(2);
  }
  Random random(seed_for(seed, 400));
  const double wear = random.uniform();
  options.tablet.damage = {wear, random.uniform(), random.uniform(), random.uniform(), 0};
  options.tablet.damage.holes = args.holes ? random.uniform(0.4, 1.0) : 0.0;
  options.tablet.damage.hole_radius_mm = args.hole_radius_mm;
  options.tablet.damage.hole_depth_mm = args.hole_depth_mm;
  if (args.crack_depth_mm > 0) {
    options.tablet.damage.cracks = 1.0;
    options.tablet.damage.crack_depth_mm = args.crack_depth_mm;
  }
  options.station.scanner = sim::scanner_for(options.tablet.size_mm, args.spacing_mm, args.noise_mm);
  options.station.scanner.seed = seed;
  options.station.seed = seed;
  options.registered = args.registered;
  return options;
}

/// What is left in the end, beside the truth.
void print_targets(const ClosedLoop& loop, const RedMapResult& red) {
  JobContext job;
  const std::vector<std::uint8_t> out_of_reach = loop.truth().unreachable(loop.sampled(), job);
  for (const RedTarget& t : red.targets.targets) {
    if (t.state == RegionState::kExcused && t.area_mm2 <= 0) {
      continue;
    }
    const RigidTransform tablet_from_model = loop.tablet_from_model();
    const Eigen::Vector3f p = (tablet_from_model * t.position_mm).cast<float>();
    const Eigen::Vector3f s = (tablet_from_model * t.sample_mm).cast<float>();
    const auto to_surface = const_cast<ClosedLoop&>(loop).station().query().closest(p, 5.0F);
    const auto of_sample = const_cast<ClosedLoop&>(loop).station().query().closest(s, 5.0F);
    std::size_t near = 0;
    std::size_t open = 0;
    std::size_t never = 0;
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    for (std::size_t i = 0; i < loop.truth().size(); ++i) {
      if ((loop.truth().points()[i] - p).norm() < 0.4F) {
        ++near;
        open += loop.sampled()[i] == 0 ? 1 : 0;
        never += out_of_reach[i];
        normal += loop.truth().normals()[i];
      }
    }
    std::printf(
        "      %s%s %.4f mm2 at %6.2f %6.2f %6.2f, off %.3f (sample %.3f) mm, tried %zu, open %zu of %zu, "
        "out of reach %zu, n.n %.2f %s\n",
        t.state == RegionState::kRed ? "red" : to_string(t.excuse),
        t.rim      ? " rim"
        : t.unseen ? " unseen"
                   : "",
        t.area_mm2, p.x(), p.y(), p.z(), to_surface ? to_surface->distance_mm : -1.0,
        of_sample ? of_sample->distance_mm : -1.0, t.tried.size(), open, near, never,
        t.normal.cast<float>().dot(normal.normalized()), t.reason.c_str());
  }
}

/// Groups of true surface that no scan sampled well, and what the program thinks of their places.
void print_open(const ClosedLoop& loop) {
  const SurfaceCover cover(loop.placed());
  std::vector<std::uint32_t> open;
  for (std::uint32_t i = 0; i < loop.truth().size(); ++i) {
    if (loop.sampled()[i] == 0) {
      open.push_back(i);
    }
  }
  UnionFind sets(open.size());
  for (std::uint32_t a = 0; a < open.size(); ++a) {
    for (std::uint32_t b = a + 1; b < open.size(); ++b) {
      if ((loop.truth().points()[open[a]] - loop.truth().points()[open[b]]).norm() < 0.5F) {
        sets.join(a, b);
      }
    }
  }
  std::map<std::uint32_t, std::vector<std::uint32_t>> groups;
  for (std::uint32_t a = 0; a < open.size(); ++a) {
    groups[sets.find(a)].push_back(open[a]);
  }
  const RigidTransform model_from_tablet = loop.tablet_from_model().inverse();
  for (const auto& [root, group] : groups) {
    const Eigen::Vector3f p = loop.truth().points()[group.front()];
    const Eigen::Vector3f n = loop.truth().normals()[group.front()];
    const auto place = cover.at(model_from_tablet * p.cast<double>(), cover.reach_mm());
    std::printf("      open %.3f mm2 at %6.2f %6.2f %6.2f normal %5.2f %5.2f %5.2f, cover %s\n",
                static_cast<double>(group.size()) * loop.truth().area_of_point_mm2(), p.x(), p.y(), p.z(),
                n.x(), n.y(), n.z(),
                place == SurfaceCover::Place::kRim      ? "rim"
                : place == SurfaceCover::Place::kClosed ? "closed"
                                                        : "bare");
  }
}

TabletResult run(const LoopOptions& options, const Arguments& args) {
  ClosedLoop loop(options);
  JobContext job;
  TabletResult result;
  result.area_mm2 = loop.truth().area_mm2();
  std::vector<double> shares;
  std::optional<Placement> placement;
  std::optional<RedMapResult> before;
  while (loop.scans() < args.max_scans) {
    const double predicted =
        before && !before->map.next.empty() ? before->map.next.front().predicted_cleared_mm2 : 0;
    const bool placed = loop.scan(placement);
    const auto start = std::chrono::steady_clock::now();
    RedMapResult red = loop.red_map();
    const double plan_s = seconds_since(start);
    shares.push_back(loop.share_sampled());
    double actual = 0;
    if (before && placed) {
      actual = cleared_area_mm2(before->targets, loop.placed().back());
      result.gains.push_back({predicted, actual, actual / result.area_mm2});
    }
    if (args.verbose) {
      std::printf(
          "  %2d plan %.3f s | red %8.2f mm2 in %4zu | predicted %7.2f actual %7.2f | truth %.5f%s | %s\n",
          loop.scans() - 1, plan_s, red_area(red.targets), red.targets.targets.size(), predicted, actual,
          loop.share_sampled(),
          red.map.conclusive ? " CONCLUSIVE"
          : placed           ? ""
                             : " LOST",
          red.map.next.empty() ? "" : red.map.next.front().say.c_str());
      for (const double mm : loop.pose_errors_mm()) {
        std::printf(" %.4f", mm);
      }
      std::printf(" mm off\n");
      if (red.map.conclusive || red.map.next.empty() || loop.scans() >= args.max_scans) {
        print_targets(loop, red);
      }
    }
    const bool done = red.map.conclusive || red.map.next.empty();
    result.conclusive = red.map.conclusive;
    if (!done) {
      placement = red.map.next.front().placement;
    }
    before = std::move(red);
    if (done) {
      break;
    }
  }
  if (args.verbose) {
    print_open(loop);
  }
  const std::vector<double> pose_errors_mm = loop.pose_errors_mm();
  result.worst_pose_mm = *std::max_element(pose_errors_mm.begin(), pose_errors_mm.end());
  result.scans = loop.scans();
  result.red_mm2 = red_area(before->targets);
  result.share_sampled = loop.share_sampled();
  result.share = loop.truth().share_of_reachable(loop.sampled(), job);
  while (result.scans_to_999 < result.scans &&
         shares[static_cast<std::size_t>(result.scans_to_999)] < 0.999 * shares.back()) {
    ++result.scans_to_999;
  }
  ++result.scans_to_999;
  result.excuses = loop.truth().judge(before->targets.targets, loop.tablet_from_model(),
                                      before->targets.cell_mm, loop.sampled(), job);
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments args;
  CLI::App app("conclusive scans against the truth");
  app.add_option("--tablets", args.tablets);
  app.add_option("--first", args.first);
  app.add_option("--spacing", args.spacing_mm);
  app.add_option("--noise", args.noise_mm);
  app.add_option("--max-scans", args.max_scans);
  app.add_flag("--registered", args.registered, "poses by registration, not the true ones");
  app.add_flag("--baselines", args.baselines, "greedy set cover, turntable, boundary following beside it");
  app.add_flag("--holes", args.holes, "tablets with firing holes, mostly out of any scanner's sight");
  app.add_option("--hole-radius", args.hole_radius_mm, "of all holes, mm; else 0.5 to 1.4");
  app.add_option("--hole-depth", args.hole_depth_mm, "of all holes, mm; else 1.5 to 5");
  app.add_option("--crack-depth", args.crack_depth_mm,
                 "many cracks of this depth, mm; else some of 0.25 to 0.7");
  app.add_option("--size", args.size, "of all tablets, WxHxT in mm");
  app.add_flag("-v,--verbose", args.verbose);
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }

  std::vector<double> shares, outside_slits, errors, interpolation;
  double unreachable = 0, truly = 0, unneeded = 0, area = 0, worst_pose_mm = 0;
  int misplaced = 0;
  int conclusive = 0, scans = 0, greedy = 0, greedy_999 = 0, scans_999 = 0, turntable = 0, boundary = 0;
  int not_below_turntable = 0, not_below_boundary = 0;
  for (int k = 0; k < args.tablets; ++k) {
    const LoopOptions options = loop_options(args.first + static_cast<std::uint64_t>(k), args);
    const auto start = std::chrono::steady_clock::now();
    const TabletResult r = run(options, args);
    conclusive += r.conclusive ? 1 : 0;
    if (r.conclusive) {
      shares.push_back(r.share.of_reachable);
      outside_slits.push_back(r.share.outside_slits);
    }
    unreachable += r.excuses.unreachable_mm2;
    truly += r.excuses.truly_unreachable_mm2;
    unneeded += r.excuses.unneeded_mm2;
    area += r.area_mm2;
    scans += r.scans;
    scans_999 += r.scans_to_999;
    interpolation.insert(interpolation.end(), r.excuses.interpolation_error_mm.begin(),
                         r.excuses.interpolation_error_mm.end());
    for (const Gain& g : r.gains) {
      if (g.share >= 0.01) {
        errors.push_back(std::abs(g.predicted - g.actual) / g.actual);
      }
    }
    std::printf(
        "%4llu: %.0fx%.0fx%.0f %s %d scans (%d to 99.9 %%), red left %.2f mm2, share %.5f (%.5f outside "
        "slits), unreachable %.2f mm2 (%.2f truly), "
        "unneeded %.3f, poses within %.4f mm; %.1f s",
        static_cast<unsigned long long>(options.tablet.seed), options.tablet.size_mm.x(),
        options.tablet.size_mm.y(), options.tablet.size_mm.z(),
        r.conclusive ? "conclusive" : "NOT CONCLUSIVE", r.scans, r.scans_to_999, r.red_mm2,
        r.share.of_reachable, r.share.outside_slits, r.excuses.unreachable_mm2,
        r.excuses.truly_unreachable_mm2, r.excuses.unneeded_mm2, r.worst_pose_mm, seconds_since(start));
    worst_pose_mm = std::max(worst_pose_mm, r.worst_pose_mm);
    misplaced += r.worst_pose_mm > kMisplacedMm ? 1 : 0;
    if (args.baselines) {
      const auto again = std::chrono::steady_clock::now();
      const int g = greedy_cover(options, r.share_sampled, 0.3, args.max_scans);
      const int g999 = greedy_cover(options, 0.999 * r.share_sampled, 0.3, args.max_scans);
      const int t = uniform_turntable(options, args.max_scans);
      const int b = boundary_following(options, args.max_scans);
      greedy += g;
      greedy_999 += g999;
      turntable += t;
      boundary += b;
      not_below_turntable += r.scans >= t ? 1 : 0;
      not_below_boundary += r.scans >= b ? 1 : 0;
      std::printf(" | greedy %d (%d to 99.9 %%), turntable %d, boundary %d; %.1f s", g, g999, t, b,
                  seconds_since(again));
    }
    std::printf("\n");
    std::fflush(stdout);
  }
  const auto n = static_cast<double>(args.tablets);
  std::printf("conclusive %d of %d; sampled of the reachable: least %.5f, median %.5f, below 0.999: %td\n",
              conclusive, args.tablets, quantile(shares, 0), quantile(shares, 0.5),
              std::count_if(shares.begin(), shares.end(), [](double s) { return s < 0.999; }));
  std::printf("outside slits narrower than 3 spacings: least %.5f, median %.5f, below 0.999: %td\n",
              quantile(outside_slits, 0), quantile(outside_slits, 0.5),
              std::count_if(outside_slits.begin(), outside_slits.end(), [](double s) { return s < 0.999; }));
  std::printf(
      "excused as unreachable %.2f mm2, of it truly %.1f %%; unneeded %.4f %% of the surface, interpolation "
      "good to %.1f um (95 %%, %zu)\n",
      unreachable, unreachable > 0 ? 100 * truly / unreachable : 100.0, 100 * unneeded / area,
      1000 * quantile(interpolation, 0.95), interpolation.size());
  std::printf("poses: worst %.4f mm; tablets with a scan more than %.1f mm off: %d\n", worst_pose_mm,
              kMisplacedMm, misplaced);
  std::printf("scans: mean %.2f, to 99.9 %% of that %.2f", scans / n, scans_999 / n);
  if (args.baselines) {
    std::printf(
        "; greedy %.2f (ratio %.3f), greedy to 99.9 %% %.2f (ratio %.3f); turntable %.2f (not below: %d), "
        "boundary %.2f (not below: %d)",
        greedy / n, static_cast<double>(scans) / greedy, greedy_999 / n,
        static_cast<double>(scans) / greedy_999, turntable / n, not_below_turntable, boundary / n,
        not_below_boundary);
  }
  std::printf(
      "\npredicted against actual over %zu scans that clear 1 %%: median error %.1f %%, quartiles %.1f and "
      "%.1f %%\n",
      errors.size(), 100 * quantile(errors, 0.5), 100 * quantile(errors, 0.25), 100 * quantile(errors, 0.75));
  return 0;
}
