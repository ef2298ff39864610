// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Calibration on real photographs that others have taken and published results for: OpenCV's chessboards, the
// Ciclop scanner, a desktop turntable. Prints what is found beside what was published.
//   dubsar-real-rigs DATA [--pictures DIR]   (DATA: the folder with opencv_chessboard, ciclop,
//   desktop_turntable)

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "acquisition/calibration.h"
#include "acquisition/calibration_laser.h"
#include "acquisition/stripe_points.h"
#include "bench/accuracy/real_table.h"
#include "bench/support/asked.h"
#include "bench/support/options.h"
#include "formats/gray_file.h"
#include "formats/mesh_io.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> pictures_in(const fs::path& folder, const std::string& prefix) {
  std::vector<fs::path> out;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().filename().string().starts_with(prefix) && entry.path().extension() == ".jpg") {
      out.push_back(entry.path());
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<CalibrationView> boards_in(const std::vector<fs::path>& files, const BoardSpec& spec) {
  std::vector<CalibrationView> out;
  for (const fs::path& file : files) {
    const Result<GrayImage> image = read_gray(file);
    if (!image) {
      continue;
    }
    if (Result<BoardView> board = find_board(image->view(), spec, file.filename().string())) {
      out.emplace_back();
      out.back().board = std::move(*board);
    }
  }
  return out;
}

/// One channel (0 blue, 1 green, 2 red) less the mean of the other two: a coloured laser on grey things.
GrayImage coloured(const fs::path& file, int channel) {
  const cv::Mat image = cv::imread(file.string(), cv::IMREAD_COLOR);
  GrayImage out(image.cols, image.rows);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      const auto& p = image.at<cv::Vec3b>(v, u);
      const int others = (p[(channel + 1) % 3] + p[(channel + 2) % 3]) / 2;
      out.pixels[out.index(u, v)] = static_cast<std::uint8_t>(std::clamp(p[channel] - others, 0, 255));
    }
  }
  return out;
}

const cv::Vec3b kMagenta{255, 0, 255}, kBlue{255, 0, 0}, kRed{0, 0, 255};

/// Points of one colour.
struct Marks {
  std::vector<Eigen::Vector2d> at_px;
  cv::Vec3b colour = kMagenta;
};

void draw(const fs::path& from, const std::vector<Marks>& marks, const fs::path& to) {
  cv::Mat image = cv::imread(from.string(), cv::IMREAD_COLOR);
  for (const Marks& one : marks) {
    for (const Eigen::Vector2d& p : one.at_px) {
      const cv::Point at(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
      if (at.x >= 0 && at.y >= 0 && at.x < image.cols && at.y < image.rows) {
        image.at<cv::Vec3b>(at) = one.colour;
      }
    }
  }
  cv::imwrite(to.string(), image);
}

void chessboards(const fs::path& data, Asked& asked) {
  for (const auto& [side, published] : {std::pair{"left", 0.3926}, {"right", 0.0}}) {
    const BoardSpec spec = *parse_board("chessboard:9x6:25");
    const std::vector<CalibrationView> views = boards_in(pictures_in(data / "opencv_chessboard", side), spec);
    CalibrationOptions options;
    options.board = spec;
    const Result<Intrinsics> start = find_intrinsics(views, {.least_views = 4, .outlier_factor = 0});
    const Result<CalibrationReport> report = calibrate_rig(views, options);
    if (!start || !report) {
      std::printf("opencv_chessboard %s: %s\n", side,
                  (start ? report.error() : start.error()).line().c_str());
      asked.nothing_of(std::string("the camera of opencv_chessboard, ") + side);
      continue;
    }
    constexpr double kRounding_px = 1e-4;
    asked.at_most(std::string("opencv_chessboard ") + side, report->rig.quality.corner_rms_px,
                  start->rms_px + kRounding_px, "px");
    std::printf("opencv_chessboard %s, %zu views: rms %.4f px, calibrateCamera on the same corners %.4f",
                side, views.size(), report->rig.quality.corner_rms_px, start->rms_px);
    if (published > 0) {
      std::printf(", published %.4f; focal length %.1f (published 535.9)", published,
                  report->rig.camera.fx_px);
    }
    std::printf("\n");
  }
}

/// Returns the angle between them, degrees.
double angle_and_offset(const char* what, const Plane& is, Plane should) {
  if (is.normal.dot(should.normal) < 0) {
    should = {-should.normal, -should.distance_mm};
  }
  std::printf("  %s: normal %.5f %.5f %.5f, published %.5f %.5f %.5f\n", what, is.normal.x(), is.normal.y(),
              is.normal.z(), should.normal.x(), should.normal.y(), should.normal.z());
  const double angle_deg = std::acos(std::min(1.0, is.normal.dot(should.normal))) * 180 / M_PI;
  std::printf(
      "  %s: %.3f° and %.3f mm off the published plane (distance from the camera %.2f, published %.2f)\n",
      what, angle_deg, is.distance_mm - should.distance_mm, is.distance_mm, should.distance_mm);
  return angle_deg;
}

/// Which of two planes of light the authors' own photographs show: against the stripe on their boards, and on
/// their empty table, whose size only its markers tell.
void desktop_planes(const fs::path& data, const fs::path& pictures, const std::vector<CalibrationView>& views,
                    const RigCalibration& rig, const Plane& published) {
  const BoardSpec spec = *parse_board("chessboard:8x6:40");
  constexpr double kPlate_mm = 100;
  std::vector<Eigen::Vector3d> on_boards;
  for (const StripeSample& sample : stripe_samples(views, seen_by(rig.camera, views), spec, kPlate_mm)) {
    on_boards.push_back(sample.point_mm);
  }
  const fs::path photo = data / "desktop_turntable/frames/TableCalib.jpg";
  const Result<GrayImage> gray = read_gray(photo);
  constexpr double kMarker_mm = 30;
  const Result<MarkedTable> table =
      gray ? find_marked_table(*gray, rig.camera, kMarker_mm) : std::unexpected(gray.error());
  if (!table) {
    std::printf("  %s\n", table.error().line().c_str());
    return;
  }
  StripeOptions options;
  options.axis = StripeAxis::kPerRow;
  StripeProfile profile;
  StripeExtractor(options).extract(coloured(photo, 1).view(), {}, profile);
  const Eigen::Vector3d middle = table->camera_from_table.translation_mm;
  const std::vector<Eigen::Vector2d> stripe = stripe_points(profile, options.axis);
  const std::vector<Eigen::Vector3d> on_table =
      stripe_on_plane(stripe, rig.camera, table->top(), middle, 1.4 * table->circle_mm);
  std::printf(
      "  table: markers of %.0f mm on a circle of %.1f mm radius, %.2f px rms, %.0f mm away; %zu rows of "
      "stripe "
      "on it\n",
      kMarker_mm, table->circle_mm, table->rms_px, middle.z(), on_table.size());
  std::vector<Marks> marks{{stripe, kMagenta}};
  for (const auto& [light, name, colour] :
       {std::tuple{&rig.laser, "found", kBlue}, std::tuple{&published, "published", kRed}}) {
    std::printf(
        "  the plane %s: stripe on the boards %.2f mm off it (median); stripe on the table %.1f mm off it, "
        "at "
        "%.2f° to it\n",
        name, miss(*light, on_boards).median_mm, miss(*light, on_table).median_mm,
        miss(*light, on_table).angle_rad * 180 / M_PI);
    marks.push_back({crossing_px(*light, table->top(), rig.camera, middle, 1.6 * table->circle_mm), colour});
  }
  if (!pictures.empty()) {
    draw(photo, marks, pictures / "desktop_table.png");
  }
}

void desktop(const fs::path& data, const fs::path& pictures, Asked& asked) {
  const BoardSpec spec = *parse_board("chessboard:8x6:40");
  std::vector<fs::path> lens = pictures_in(data / "desktop_turntable/camera", "Image");
  const Result<Intrinsics> camera = find_intrinsics(boards_in(lens, spec));
  if (!camera) {
    std::printf("desktop_turntable: %s\n", camera.error().line().c_str());
    asked.nothing_of("the camera of desktop_turntable");
    return;
  }
  std::printf(
      "desktop_turntable: camera from %zu views, rms %.3f px, fx %.2f (published 620.27), cx %.2f (322.95), "
      "cy "
      "%.2f (239.42)\n",
      camera->used.size(), camera->rms_px, camera->camera.fx_px, camera->camera.cx_px, camera->camera.cy_px);
  std::vector<CalibrationView> views;
  std::size_t samples = 0;
  for (const fs::path& file : pictures_in(data / "desktop_turntable/laser_on_board", "Image")) {
    std::vector<CalibrationView> one = boards_in({file}, spec);
    if (one.empty()) {
      continue;
    }
    StripeOptions options;
    options.axis = StripeAxis::kPerRow;
    options.sigma_px = 1.5;
    StripeProfile profile;
    const GrayImage image = coloured(file, 1);
    StripeExtractor(options).extract(image.view(), {}, profile);
    one[0].stripe_px = stripe_points(profile, options.axis);
    samples += one[0].stripe_px.size();
    if (!pictures.empty() && views.size() % 20 == 0) {
      draw(file, {{one[0].stripe_px}}, pictures / ("desktop_" + file.stem().string() + ".png"));
    }
    views.push_back(std::move(one[0]));
  }
  // The plate around the print is white: its edge shows some 90 mm of it beside the squares.
  CalibrationOptions options;
  options.board = spec;
  options.plate_margin_mm = 100;
  options.depth_range_mm = 200;
  options.most_stripe_px = 3;
  options.most_volume_sigma_um = 1e4;
  const Result<CalibrationReport> report = calibrate_rig(views, options);
  if (!report) {
    std::printf("  laser: %s\n", report.error().line().c_str());
    asked.nothing_of("the laser of desktop_turntable");
    return;
  }
  const CalibrationQuality& q = report->rig.quality;
  std::printf(
      "  laser from %d views (%zu stripe samples in all): stripe %.3f px, %.0f um rms; fx %.2f from these\n",
      q.stripe_views, samples, q.stripe_rms_px, q.stripe_rms_um, report->rig.camera.fx_px);
  const Eigen::Vector3d normal(-0.84630, -0.29551, 0.38939);
  const Plane published{normal.normalized(), -211.72 / normal.norm()};
  angle_and_offset("laser plane", report->rig.laser, published);
  // The published one comes nearest in a frame whose y points up and z towards the viewer, as graphics has
  // it.
  const Plane turned{{published.normal.x(), -published.normal.y(), -published.normal.z()},
                     published.distance_mm};
  angle_and_offset("the same, y and z turned over", report->rig.laser, turned);
  desktop_planes(data, pictures, views, report->rig, turned);
}

void ciclop(const fs::path& data, const fs::path& pictures, Asked& asked) {
  const BoardSpec spec = *parse_board("chessboard:11x6:13");
  const fs::path laser = data / "ciclop/laser";
  std::vector<CalibrationView> views = boards_in(pictures_in(data / "ciclop/chessboard", "frame"), spec);
  const Result<Intrinsics> camera = find_intrinsics(views);
  if (!camera) {
    std::printf("ciclop: %s\n", camera.error().line().c_str());
    asked.nothing_of("the camera of ciclop");
    return;
  }
  std::printf("ciclop: camera from %zu of %zu views, rms %.3f px, fx %.1f, cx %.1f, cy %.1f\n",
              camera->used.size(), views.size(), camera->rms_px, camera->camera.fx_px, camera->camera.cx_px,
              camera->camera.cy_px);
  // The published cloud is of the laser's plane itself: as a check of the plane fit.
  const Result<Mesh> cloud = read_mesh(data / "ciclop/laser-pc.ply");
  if (cloud) {
    std::vector<Eigen::Vector3d> points;
    for (const Eigen::Vector3f& p : cloud->positions) {
      points.push_back(p.cast<double>());
    }
    if (const Result<PlaneFit> fit = fit_plane(points)) {
      std::printf(
          "  plane of laser-pc.ply: rms %.3f mm of %ld inliers of %zu (published 0.054 with RANSAC, 0.088 "
          "plain)\n",
          fit->rms_mm, std::count(fit->inlier.begin(), fit->inlier.end(), 1), points.size());
      const Plane published{Eigen::Vector3d(0.85111, -0.00123, 0.52499).normalized(), 159.527};
      angle_and_offset("fit", fit->plane, published);
      // The published plane goes through all points, the stray ones too. Its distance is that at the camera,
      // far from the points.
      asked.at_most(
          "ciclop: least squares of all points, off the published plane",
          angle_and_offset("least squares of all points", least_squares_plane(points).plane, published), 0.01,
          "degrees");
      const Plane other = fit->plane.normal.dot(published.normal) < 0
                              ? Plane{-fit->plane.normal, -fit->plane.distance_mm}
                              : fit->plane;
      double most = 0;
      for (const Eigen::Vector3d& p : points) {
        most = std::max(most, std::abs(other.signed_distance_mm(p) - published.signed_distance_mm(p)));
      }
      std::printf("  the fit and the published plane are %.3f mm apart at most where there are points\n",
                  most);
    }
  }
  // The bust with the laser on and off: how much of the line is found.
  const GrayImage on = coloured(laser / "laser.png", 2);
  const GrayImage off = coloured(laser / "laser_background.png", 2);
  StripeOptions options;
  options.axis = StripeAxis::kPerRow;
  options.sigma_px = 2.5;
  StripeProfile profile;
  StripeExtractor(options).extract(on.view(), off.view(), profile);
  const std::vector<Eigen::Vector2d> found = stripe_points(profile, options.axis);
  std::printf(
      "  laser on the bust: %zu of %d rows have a stripe; %zu without, %zu doubtful, %zu wide, %zu "
      "saturated\n",
      found.size(), on.height, profile.count_of(StripeState::kNone),
      profile.count_of(StripeState::kReflection), profile.count_of(StripeState::kWide),
      profile.count_of(StripeState::kSaturated));
  if (!pictures.empty()) {
    draw(laser / "laser.png", {{found}}, pictures / "ciclop_bust.png");
  }
}

int run(int argc, char** argv) {
  CLI::App app("Calibration on real photographs beside what was published", "dubsar-real-rigs");
  std::string data = "../shared/data";
  std::string pictures;
  app.add_option("data", data);
  app.add_option("--pictures", pictures,
                 "Draw the stripes that were found into copies of the photographs, here");
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  if (!pictures.empty()) {
    fs::create_directories(pictures);
  }
  Asked asked;
  chessboards(data, asked);
  ciclop(data, pictures, asked);
  desktop(data, pictures, asked);
  return asked.status();
}

}  // namespace
}  // namespace dubsar

int main(int argc, char** argv) {
  return dubsar::run(argc, argv);
}
