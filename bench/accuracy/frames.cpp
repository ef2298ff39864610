// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The stripe detectors against each other on simulated frames, and the whole way from frames to a grid
// against the true surface: px and µm.
//   dubsar-frames [--frames N] [--step MM] [--height PX] [--contrast C …] [--f-number N]
//     [--laser-sigma MM] [--seed N]

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <memory>
#include <thread>
#include <vector>

#include "acquisition/row_window.h"
#include "acquisition/swept_light.h"
#include "acquisition/triangulate.h"
#include "bench/support/asked.h"
#include "bench/support/options.h"
#include "bench/support/rig_tablet.h"
#include "core/stage_times.h"
#include "sim/frame_renderer.h"
#include "sim/frame_rig.h"
#include "sim/speckle_bound.h"

namespace dubsar {
namespace {

struct Setup {
  RigCalibration rig;
  std::unique_ptr<RigTablet> clay;
};

/// The tablet with its obverse in the middle of the volume, camera frame, stage at `position`.
RigidTransform tablet_from_camera(const Setup& setup, double position) {
  RigidTransform tablet_from_scanner;
  tablet_from_scanner.translation_mm.z() = setup.clay->top_mm - 1.0;
  return tablet_from_scanner * setup.rig.scanner_from_camera() * setup.rig.motion.zero_from_camera(position);
}

struct Errors {
  std::vector<double> values;
  std::size_t outliers = 0;
  double limit = 0;
  void add(double error) {
    if (std::abs(error) > limit) {
      ++outliers;
    } else {
      values.push_back(error);
    }
  }
  [[nodiscard]] double bias() const {
    double sum = 0;
    for (const double e : values) {
      sum += e;
    }
    return values.empty() ? 0 : sum / static_cast<double>(values.size());
  }
  [[nodiscard]] double rms() const {
    double sum = 0;
    for (const double e : values) {
      sum += e * e;
    }
    return values.empty() ? 0 : std::sqrt(sum / static_cast<double>(values.size()));
  }
  [[nodiscard]] double outlier_share() const {
    const std::size_t all = values.size() + outliers;
    return all == 0 ? 0 : static_cast<double>(outliers) / static_cast<double>(all);
  }
};

/// Error of each point of a row that lies where the stripe is truly seen, mm.
void add_depths(const Setup& setup, const std::vector<double>& truth, const TriangulatedProfile& profile,
                Errors& mm) {
  RigidTransform tablet_from_scanner;
  tablet_from_scanner.translation_mm.z() = setup.clay->top_mm - 1.0;
  for (std::size_t u = 0; u < profile.valid.size(); ++u) {
    if (profile.valid[u] == 0 || !std::isfinite(truth[u])) {
      continue;
    }
    const Eigen::Vector3d p = tablet_from_scanner * Eigen::Vector3d(static_cast<double>(profile.x[u]),
                                                                    static_cast<double>(profile.y[u]),
                                                                    static_cast<double>(profile.z[u]));
    const auto hit = setup.clay->query.first_hit((p + Eigen::Vector3d(0, 0, 1)).cast<float>(),
                                                 -Eigen::Vector3f::UnitZ(), 0, 3);
    mm.add(hit ? hit->distance_mm - 1.0 : 99.0);
  }
}

/// What the default detector leaves in the picture, by what the clay is like within the width of the sheet.
/// Plane: where the sheet's middle, and its light two standard deviations to either side of that, see the
/// clay in rows of the picture that lie on a line, to kPlane_px. Bent: they do not, or one of them sees none.
class ByShape {
 public:
  ByShape(const Setup& setup, const sim::FrameRenderer& renderer, double sheet_sigma_mm)
      : setup_(setup), renderer_(renderer), aside_mm_(2 * sheet_sigma_mm) {}

  void add(double position, const std::vector<double>& truth, const StripeProfile& stripe) {
    const auto rows_at = [&](double there) {
      return renderer_.true_rows(sim::SceneTarget(setup_.clay->scene, tablet_from_camera(setup_, there)),
                                 there);
    };
    const std::vector<double> before = rows_at(position - aside_mm_);
    const std::vector<double> behind = rows_at(position + aside_mm_);
    for (std::size_t u = 0; u < truth.size(); ++u) {
      if (stripe.state[u] != StripeState::kGood || !std::isfinite(truth[u])) {
        continue;
      }
      const double bend = 0.5 * std::abs(before[u] + behind[u] - 2 * truth[u]);
      (bend < kPlane_px ? plane_ : bent_).add(static_cast<double>(stripe.at_px[u]) - truth[u]);
    }
  }
  void print() const {
    const std::size_t all = plane_.values.size() + plane_.outliers + bent_.values.size() + bent_.outliers;
    if (all == 0) {
      return;
    }
    for (const auto& [errors, name] :
         {std::pair{&plane_, "plane within the sheet"}, std::pair{&bent_, "bent within the sheet"}}) {
      std::printf(
          "  adaptive, clay %s: %5.1f%% of the samples, %.4f px rms, bias %.4f px, %.2f%% off by more than 1 "
          "px\n",
          name,
          100.0 * static_cast<double>(errors->values.size() + errors->outliers) / static_cast<double>(all),
          errors->rms(), errors->bias(), 100 * errors->outlier_share());
    }
  }

 private:
  static constexpr double kPlane_px = 0.1;
  const Setup& setup_;
  const sim::FrameRenderer& renderer_;
  double aside_mm_;
  Errors plane_{{}, 0, 1.0}, bent_{{}, 0, 1.0};
};

/// Each row together with those on either side, as a scan of rows `step_mm` apart has them. Their depth rms,
/// um.
double compare_swept(const Setup& setup, const sim::FrameOptions& optics,
                     const std::vector<double>& positions, const std::vector<GrayImage>& off,
                     double step_mm) {
  const Triangulator triangulator(setup.rig, StripeAxis::kPerColumn);
  StripeOptions options;
  options.keep_light = true;
  const SweptLight light(triangulator, options.sigma_px);
  const int reach = light.reach(step_mm);
  const sim::FrameRenderer renderer(setup.rig, optics);
  StripeExtractor extractor(options);
  Errors mm{{}, 0, setup.rig.depth_per_px_mm()};
  double cpu_seconds = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    std::vector<SweptRow> rows;
    std::vector<const SweptRow*> around;
    std::vector<double> truth;
    for (int k = -reach; k <= reach; ++k) {
      SweptRow row;
      row.position = positions[i] + k * step_mm;
      const sim::SceneTarget target(setup.clay->scene, tablet_from_camera(setup, row.position));
      const auto number = 1000 * (i + 1) + static_cast<std::uint64_t>(k + reach);
      const GrayImage on = renderer.render(target, true, row.position, number);
      extractor.extract(on.view(), off.empty() ? GrayView{} : off[i].view(), row.stripe);
      rows.push_back(std::move(row));
      if (k == 0) {
        truth = renderer.true_rows(target, positions[i]);
      }
    }
    for (const SweptRow& row : rows) {
      around.push_back(&row);
    }
    const auto middle = static_cast<std::size_t>(reach);
    TriangulatedProfile profile;
    triangulator.triangulate(rows[middle].stripe, positions[i], profile);
    const std::clock_t busy = std::clock();
    light.correct(around, middle, profile);
    cpu_seconds += static_cast<double>(std::clock() - busy) / CLOCKS_PER_SEC;
    add_depths(setup, truth, profile, mm);
  }
  std::printf("  adaptive, %d rows on either side, %.0f um apart: %17.2f %9.2f %7.2f%% %8.0f more\n", reach,
              1e3 * step_mm, 1e3 * mm.rms(), -1e3 * mm.bias(), 100 * mm.outlier_share(),
              1e6 * cpu_seconds / static_cast<double>(positions.size()));
  return 1e3 * mm.rms();
}

/// Judged is what the default detector makes of light without speckle (a written tablet's stripe in one
/// picture is not: it misses 0.05 px, docs/developers/scanners.md says why), and depth against speckle's
/// bound.
void compare(const Setup& setup, const sim::FrameOptions& optics, int frames, bool ambient_frames,
             double step_mm, bool written, Asked& asked) {
  constexpr double kStripe_px = 0.05;
  constexpr double kDepth_um = 3;
  constexpr double kOfBound = 1.2;
  const sim::FrameRenderer renderer(setup.rig, optics);
  std::vector<GrayImage> on;
  std::vector<GrayImage> off;
  std::vector<std::vector<double>> truth;
  std::vector<double> positions;
  for (int i = 0; i < frames; ++i) {
    const double position = frames == 1 ? 0 : -6.0 + 12.0 * i / (frames - 1);
    const sim::SceneTarget target(setup.clay->scene, tablet_from_camera(setup, position));
    positions.push_back(position);
    on.push_back(renderer.render(target, true, position, static_cast<std::uint64_t>(2 * i)));
    if (ambient_frames) {
      off.push_back(renderer.render(target, false, position, static_cast<std::uint64_t>(2 * i + 1)));
    }
    truth.push_back(renderer.true_rows(target, position));
  }
  const double depth_per_px = setup.rig.depth_per_px_mm();
  const Triangulator triangulator(setup.rig, StripeAxis::kPerColumn);
  const double bound_um = sim::speckle_bound_um(setup.rig, optics, {});
  std::printf("contrast %.2f, f/%.1f, %s: bound %.1f um in depth\n", optics.speckle_contrast, optics.f_number,
              ambient_frames ? "ambient frames" : "no ambient frames", bound_um);
  std::printf("  %-9s %9s %9s %9s %8s %9s %9s %8s %8s\n", "method", "rms px", "bias px", "out >1px", "good",
              "depth um", "bias um", "out", "us/frame");
  for (const auto& [method, name] : {std::pair{StripeMethod::kAdaptive, "adaptive"},
                                     {StripeMethod::kCentroid, "centroid"},
                                     {StripeMethod::kGaussian, "gaussian"},
                                     {StripeMethod::kSteger, "steger"}}) {
    StripeOptions options;
    options.method = method;
    StripeExtractor extractor(options);
    StripeProfile stripe;
    TriangulatedProfile profile;
    Errors px{{}, 0, 1.0};
    Errors mm{{}, 0, depth_per_px};
    std::size_t good = 0;
    std::size_t visible = 0;
    ByShape by_shape(setup, renderer, optics.laser_sigma_mm);
    for (std::size_t i = 0; i < on.size(); ++i) {
      extractor.extract(on[i].view(), ambient_frames ? off[i].view() : GrayView{}, stripe);
      triangulator.triangulate(stripe, positions[i], profile);
      add_depths(setup, truth[i], profile, mm);
      if (method == StripeMethod::kAdaptive) {
        by_shape.add(positions[i], truth[i], stripe);
      }
      for (std::size_t u = 0; u < stripe.at_px.size(); ++u) {
        visible += std::isfinite(truth[i][u]) ? 1 : 0;
        if (stripe.state[u] == StripeState::kGood && std::isfinite(truth[i][u])) {
          ++good;
          px.add(static_cast<double>(stripe.at_px[u]) - truth[i][u]);
        }
      }
    }
    const auto start = std::chrono::steady_clock::now();
    constexpr int kRounds = 20;
    for (int round = 0; round < kRounds; ++round) {
      for (std::size_t i = 0; i < on.size(); ++i) {
        extractor.extract(on[i].view(), ambient_frames ? off[i].view() : GrayView{}, stripe);
        triangulator.triangulate(stripe, positions[i], profile);
      }
    }
    const double seconds = seconds_since(start);
    std::printf("  %-9s %9.4f %9.4f %8.2f%% %7.1f%% %9.2f %9.2f %7.2f%% %8.0f\n", name, px.rms(), px.bias(),
                100 * px.outlier_share(), 100.0 * static_cast<double>(good) / static_cast<double>(visible),
                1e3 * mm.rms(), -1e3 * mm.bias(), 100 * mm.outlier_share(),
                1e6 * seconds / (kRounds * static_cast<double>(on.size())));
    by_shape.print();
    if (method != StripeMethod::kAdaptive) {
      continue;
    }
    if (optics.speckle_contrast > 0) {
      asked.at_most("depth under speckle", 1e3 * mm.rms(), kOfBound * bound_um, "um");
    } else if (!written) {
      asked.at_most("the stripe on blank clay", px.rms(), kStripe_px, "px");
      asked.at_most("depth of blank clay", 1e3 * mm.rms(), kDepth_um, "um");
    }
  }
  const double together_um = compare_swept(setup, optics, positions, off, step_mm);
  asked.at_most("depth of rows together", together_um,
                optics.speckle_contrast > 0 ? kOfBound * bound_um : kDepth_um, "um");
}

/// Processor time of copying a frame to another place in memory.
double copy_seconds(const std::vector<GrayImage>& frames) {
  std::vector<GrayImage> to = frames;
  constexpr int kRounds = 50;
  const std::clock_t busy = std::clock();
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t k = 0; k < frames.size(); ++k) {
      std::memcpy(to[k].pixels.data(),
                  frames[(k + static_cast<std::size_t>(round)) % frames.size()].pixels.data(),
                  to[k].pixels.size());
    }
  }
  const double seconds = static_cast<double>(std::clock() - busy) / CLOCKS_PER_SEC;
  return seconds / (kRounds * static_cast<double>(frames.size()));
}

/// From frames in memory to profiles on two threads: each row alone, with and without an ambient frame, and
/// rows that correct each other, which go to and fro over a few places.
void throughput(const Setup& setup, const sim::FrameOptions& optics, double step_mm) {
  constexpr int kPlaces = 4;
  constexpr int kFrames = 400;
  struct Way {
    const char* name;
    bool ambient, together;
  };
  const sim::FrameRenderer renderer(setup.rig, optics);
  std::vector<GrayImage> frames;
  for (int i = 0; i < kPlaces; ++i) {
    const double position = i * step_mm;
    const sim::SceneTarget target(setup.clay->scene, tablet_from_camera(setup, position));
    frames.push_back(renderer.render(target, true, position, static_cast<std::uint64_t>(100 + 2 * i)));
    frames.push_back(renderer.render(target, false, position, static_cast<std::uint64_t>(101 + 2 * i)));
  }
  const Triangulator triangulator(setup.rig, StripeAxis::kPerColumn);
  const RowWindow::Give give = [](const Profile& /*profile*/) -> Status { return {}; };
  for (const Way& way : {Way{"no ambient frames", false, false}, Way{"ambient frame subtracted", true, false},
                         Way{"no ambient frames, rows together", false, true}}) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t busy = std::clock();
    {
      std::vector<std::jthread> workers;
      for (int worker = 0; worker < 2; ++worker) {
        workers.emplace_back([&] {
          StripeOptions options;
          options.keep_light = way.together;
          StripeExtractor extractor(options);
          RowWindow window(triangulator, options, way.together ? step_mm : 1e3);
          for (int i = 0; i < kFrames / 2; ++i) {
            const int at = i % (2 * kPlaces - 2);
            const int place = at < kPlaces ? at : 2 * kPlaces - 2 - at;
            const auto k = static_cast<std::size_t>(2 * place);
            SweptRow row{i, 0, place * step_mm, {}};
            extractor.extract(frames[k].view(), way.ambient ? frames[k + 1].view() : GrayView{}, row.stripe);
            if (!window.take(std::move(row), give)) {
              return;
            }
          }
        });
      }
    }
    const double seconds = seconds_since(start);
    // On a machine that does other things too, the time of the processors says what two idle ones would do.
    const double cpu_seconds = static_cast<double>(std::clock() - busy) / CLOCKS_PER_SEC;
    std::printf(
        "two threads, default detector, %s: %.0f frames/s as it ran, %.0f per two seconds of processor time "
        "(400 asked for)\n",
        way.name, kFrames / seconds, 2 * kFrames / cpu_seconds);
    std::printf("  a frame takes %.1f times as long as copying it\n",
                cpu_seconds / kFrames / copy_seconds(frames));
  }
}

int run(int argc, char** argv) {
  CLI::App app("Stripe detectors and triangulation on simulated frames", "dubsar-frames");
  int frames = 4;
  double f_number = 5.6;
  double sigma_mm = 0.02;
  double step_mm = 0.025;
  std::vector<double> contrasts{0, 0.5, 0.7, 1};
  std::uint64_t seed = 1;
  sim::FrameRigOptions size;
  app.add_option("--seed", seed, "Of the tablet");
  app.add_option("--frames", frames, "Frames per case")->check(CLI::Range(1, 1000));
  app.add_option("--step", step_mm, "Between rows that correct each other, mm")
      ->check(CLI::Range(0.005, 1.0));
  app.add_option("--width", size.width);
  app.add_option("--height", size.height);
  app.add_option("--field", size.field_mm);
  app.add_option("--f-number", f_number);
  app.add_option("--laser-sigma", sigma_mm, "Of the sheet, mm");
  app.add_option("--contrast", contrasts);
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  Asked asked;
  for (const bool written : {false, true}) {
    Result<std::unique_ptr<RigTablet>> clay = rig_tablet(written, seed);
    if (!clay) {
      std::fprintf(stderr, "%s\n", clay.error().line().c_str());
      return 4;
    }
    const Setup setup{sim::frame_rig(size), std::move(*clay)};
    std::printf("%s tablet, %d x %d, field %.0f mm, %.1f um a pixel, %.1f um of depth a pixel\n",
                written ? "written" : "blank", size.width, size.height, size.field_mm,
                1e3 * setup.rig.field_per_px_mm(), 1e3 * setup.rig.depth_per_px_mm());
    sim::FrameOptions optics;
    optics.f_number = f_number;
    optics.laser_sigma_mm = sigma_mm;
    for (const double contrast : contrasts) {
      sim::FrameOptions speckled = optics;
      speckled.speckle_contrast = contrast;
      compare(setup, speckled, frames, true, step_mm, written, asked);
    }
    compare(setup, optics, frames, false, step_mm, written, asked);
    throughput(setup, optics, step_mm);
  }
  return asked.status();
}

}  // namespace
}  // namespace dubsar

int main(int argc, char** argv) {
  return dubsar::run(argc, argv);
}
