// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The pictures that a live calibration takes: of a board held by hand, and of one that the stage carries.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "acquisition/calibration_folder.h"
#include "acquisition/fresh_frame.h"
#include "acquisition/live_calibration.h"
#include "acquisition/rig_parts.h"
#include "acquisition/stops_when_cancelled.h"
#include "core/number_text.h"
#include "core/order_statistics.h"
#include "formats/gray_file.h"

namespace dubsar {

namespace {

constexpr double kMovedPx = 0.5;  // corners of a board that was held still stay within this
constexpr int kLeastStops = 3;

/// How far the corners that both have lie apart, the median; nothing without such corners.
std::optional<double> moved_px(const BoardView& a, const BoardView& b) {
  std::vector<double> ways;
  for (std::size_t i = 0; i < a.corners_mm.size(); ++i) {
    for (std::size_t k = 0; k < b.corners_mm.size(); ++k) {
      if ((a.corners_mm[i] - b.corners_mm[k]).norm() < 1e-6) {
        ways.push_back((a.corners_px[i] - b.corners_px[k]).norm());
      }
    }
  }
  if (ways.empty()) {
    return std::nullopt;
  }
  return median_of(std::move(ways));
}

}  // namespace

Status LiveCalibration::expose(const std::optional<double>& exposure_us) {
  return exposure_us ? camera_.set("exposure_us", *exposure_us) : Status{};
}

Result<GrayImage> LiveCalibration::picture(bool laser, const std::optional<double>& exposure_us,
                                           const JobContext& job) {
  if (job.cancelled()) {
    return fail(ErrorKind::kCancelled, "calibration cancelled", plan_.folder.string());
  }
  if (Status exposed = expose(exposure_us); !exposed) {
    return std::unexpected(exposed.error());
  }
  const auto number = static_cast<std::uint32_t>(plan_.laser);
  if (Status lit = stage_.set_laser(number, laser ? plan_.laser_power : 0); !lit) {
    return std::unexpected(lit.error());
  }
  const Result<Frame> frame = fresh_frame(camera_, [&job] { return job.cancelled(); });
  if (!frame) {
    return std::unexpected(frame.error());
  }
  if (frame->offset_x != 0 || frame->offset_y != 0) {
    return bad_input(camera_.uri(),
                     "the camera sends a region that begins at pixel " + std::to_string(frame->offset_x) +
                         ", " + std::to_string(frame->offset_y),
                     "a rig is calibrated with a picture from 0, 0 on, of which it may scan a part "
                     "(region_px): set the camera's offsets to 0");
  }
  return gray_of(*frame);
}

Result<LiveCalibration::Taken> LiveCalibration::take_pose(const JobContext& job) {
  if (Status started = camera_.start_frames(); !started) {
    return std::unexpected(started.error());
  }
  const StreamGuard stream(camera_);
  LaserGuard dark(stage_, static_cast<std::uint32_t>(plan_.laser));
  StopsWhenCancelled watch(stage_, job);
  Result<Taken> taken = pose_while_streaming(job);
  const Status off = dark.off(taken ? Status{} : std::unexpected(taken.error()));
  if (auto refused = watch.refused()) {
    return std::unexpected(std::move(*refused));
  }
  return off ? std::move(taken) : std::unexpected(off.error());
}

Result<LiveCalibration::Taken> LiveCalibration::pose_while_streaming(const JobContext& job) {
  const std::size_t number = plan_.set.poses.size();
  CalibrationView view;
  if (plan_.set.motion == MotionKind::kGalvanometer) {
    // A third of the poses each, so that the axis shows; where its own steps take it, as a scan says it.
    const double mirror = std::lerp(plan_.from, plan_.to, 0.5 * static_cast<double>(number % 3));
    if (Status moved = stage_.move({static_cast<std::uint32_t>(plan_.axis), mirror, plan_.speed, false});
        !moved) {
      return std::unexpected(moved.error());
    }
    const Result<double> there = position_of(stage_, static_cast<std::size_t>(plan_.axis));
    if (!there) {
      return std::unexpected(there.error());
    }
    view.mirror_position = *there;
  }
  const Result<GrayImage> board = picture(false, plan_.board_exposure_us, job);
  if (!board) {
    return std::unexpected(board.error());
  }
  const std::size_t free = free_picture_number(plan_.folder, "pose", number);
  CalibrationSet::Pose names{numbered_picture("pose", free, ""), numbered_picture("pose", free, "_laser"),
                             numbered_picture("pose", free, "_dark"), view.mirror_position};
  Result<BoardView> seen = find_board(board->view(), board_, names.board);
  if (!seen) {
    return Taken{false, seen.error().what};
  }
  const Result<GrayImage> lit = picture(true, plan_.laser_exposure_us, job);
  const Result<GrayImage> dim = lit ? picture(false, plan_.laser_exposure_us, job) : lit;
  const Result<GrayImage> again = dim ? picture(false, plan_.board_exposure_us, job) : dim;
  if (!again) {
    return std::unexpected(again.error());
  }
  const Result<BoardView> later = find_board(again->view(), board_, names.board);
  const std::optional<double> moved = later ? moved_px(*seen, *later) : std::nullopt;
  if (!moved || *moved > kMovedPx) {
    return Taken{false, "the board moved by " + fixed_text(moved.value_or(99), 1) +
                            " px while the pictures were taken"};
  }
  for (const auto& [file, image] :
       {std::pair(&names.board, &*board), std::pair(&names.laser, &*lit), std::pair(&names.dark, &*dim)}) {
    if (Status written = write_gray_png(*image, plan_.folder / *file); !written) {
      return std::unexpected(written.error());
    }
  }
  view.board = std::move(*seen);
  view.laser_picture = names.laser;
  view.stripe_px = stripe_on_board(plan_.set, lit->view(), dim->view());
  plan_.set.poses.push_back(names);
  if (Status kept = keep(); !kept) {
    return std::unexpected(kept.error());
  }
  Taken out{true, std::to_string(view.board.corners_px.size()) + " of " +
                      std::to_string(board_.corner_count()) + " corners, " +
                      std::to_string(view.stripe_px.size()) + " points of the stripe"};
  views_.push_back(std::move(view));
  return out;
}

Result<LiveCalibration::Taken> LiveCalibration::take_stops(const JobContext& job) {
  if (!plan_.set.motion || *plan_.set.motion == MotionKind::kGalvanometer) {
    return fail(ErrorKind::kUsage, "nothing is carried by this stage", stage_.uri(),
                "say --motion linear or turntable, for a stage that moves camera or tablet");
  }
  if (Status started = camera_.start_frames(); !started) {
    return std::unexpected(started.error());
  }
  const StreamGuard stream(camera_);
  StopsWhenCancelled watch(stage_, job);
  Result<Taken> taken = stops_while_streaming(job);
  if (auto refused = watch.refused()) {
    return std::unexpected(std::move(*refused));
  }
  return taken;
}

Result<LiveCalibration::Taken> LiveCalibration::stops_while_streaming(const JobContext& job) {
  const auto axis = static_cast<std::uint32_t>(plan_.axis);
  constexpr std::string_view kLaid = "laid";
  int laid = 0;
  for (const CalibrationSet::Stop& had : plan_.set.stops) {  // some may have names that somebody wrote
    laid = had.fixed.starts_with(kLaid) ? std::max(laid, std::atoi(had.fixed.c_str() + kLaid.size())) : laid;
  }
  const std::string name = std::string(kLaid) + std::to_string(laid + 1);
  std::vector<CalibrationView> views;
  std::vector<CalibrationSet::Stop> stops;
  std::vector<GrayImage> pictures;
  std::size_t free = plan_.set.stops.size();
  if (Status moved = stage_.move({axis, before_, plan_.speed, false}); !moved) {
    return std::unexpected(moved.error());
  }
  for (int i = 0; i < plan_.stops; ++i) {
    job.progress("stage", static_cast<double>(i) / plan_.stops);
    const double share = static_cast<double>(i) / std::max(1, plan_.stops - 1);
    const double there = std::lerp(plan_.from, plan_.to, share);  // at the ends exactly there
    if (Status moved = stage_.move({axis, there, plan_.speed, false}); !moved) {
      return std::unexpected(moved.error());
    }
    const Result<double> position = position_of(stage_, axis);
    if (!position) {
      return std::unexpected(position.error());
    }
    Result<GrayImage> picture_now = picture(false, plan_.board_exposure_us, job);
    if (!picture_now) {
      return std::unexpected(picture_now.error());
    }
    free = free_picture_number(plan_.folder, "stage", free);
    CalibrationSet::Stop stop{numbered_picture("stage", free, ""), name, *position};
    Result<BoardView> seen = find_board(picture_now->view(), board_, stop.board);
    if (!seen) {
      continue;
    }
    CalibrationView view;
    view.board = std::move(*seen);
    view.fixed = name;
    view.stage_position = stop.position;
    views.push_back(std::move(view));
    stops.push_back(std::move(stop));
    ++free;
    pictures.push_back(std::move(*picture_now));
  }
  const std::string said =
      "seen at " + std::to_string(stops.size()) + " of " + std::to_string(plan_.stops) + " positions";
  if (static_cast<int>(stops.size()) < std::min(kLeastStops, plan_.stops)) {
    return Taken{false, said + ": lay the board so that it stays in the picture"};
  }
  for (std::size_t i = 0; i < stops.size(); ++i) {
    if (Status written = write_gray_png(pictures[i], plan_.folder / stops[i].board); !written) {
      return std::unexpected(written.error());
    }
    plan_.set.stops.push_back(stops[i]);
    views_.push_back(std::move(views[i]));
  }
  if (Status kept = keep(); !kept) {
    return std::unexpected(kept.error());
  }
  return Taken{true, said};
}

}  // namespace dubsar
