// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The continuous scan of a rig: nothing waits for anything, and the clock says what belongs together.
#include <algorithm>
#include <cmath>
#include <utility>

#include "acquisition/rig_parts.h"
#include "acquisition/rig_scan.h"
#include "acquisition/row_count.h"
#include "acquisition/stage_watch.h"
#include "acquisition/stripe_stream.h"
#include "core/number_text.h"

namespace dubsar {

namespace {

/// The camera's rate where it tells one.
std::optional<double> frame_rate_hz(const Device& camera) {
  const Result<SettingValue> told = camera.get("frame_rate_hz");
  const double* const rate = told ? std::get_if<double>(&*told) : nullptr;
  return rate != nullptr && *rate > 0 ? std::optional(*rate) : std::nullopt;
}

}  // namespace

Result<Travel> RigScanner::plan_sweep() {
  if (triangulator_->calibration().motion.kind == MotionKind::kGalvanometer) {
    return fail(ErrorKind::kUsage, "a mirror is scanned row by row", file_.name,
                "leave continuous away: an error of its time would be one of depth");
  }
  const Result<std::vector<StageAxis>> axes = stage_.axes();
  if (!axes) {
    return std::unexpected(axes.error());
  }
  const StageAxis& axis = (*axes)[static_cast<std::size_t>(file_.axis)];
  const Result<StageReading> now = stage_.motion();
  if (!now) {
    return std::unexpected(now.error());
  }
  if (const Status reports = check_reports(*now, file_); !reports) {
    return std::unexpected(reports.error());
  }
  std::optional<double> rate = frame_rate_hz(camera_);
  if (!rate) {
    // A camera that was unplugged since tells nothing: its next stream brings it back.
    if (const Status back = camera_.start_frames(); !back) {
      return std::unexpected(back.error());
    }
    if (const Status idle = camera_.stop_frames(); !idle) {
      return std::unexpected(idle.error());
    }
    rate = frame_rate_hz(camera_);
  }
  if (file_.speed <= 0 && !rate) {
    return fail(ErrorKind::kUsage, "nobody says how fast the stage is to go", file_.name,
                "the camera does not tell its rate: give speed_mm_s or speed_deg_s");
  }
  double speed = file_.speed > 0 ? file_.speed : file_.step * *rate;
  if (axis.speed_maximum > 0) {
    speed = std::min(speed, axis.speed_maximum);
  }
  // A step from frame to frame: the camera goes with the stage.
  if (const double wanted = speed / file_.step; rate && std::abs(wanted / *rate - 1) > 1e-3) {
    if (const Status set = camera_.set("frame_rate_hz", wanted); !set) {
      return fail(
          ErrorKind::kUsage,
          "the camera cannot take " + number_text(wanted) + " frames a second, which this speed asks for",
          file_.name, "scan more slowly, or leave the speed away");
    }
  }
  return travel_of(file_, axis, speed);
}

Status RigScanner::sweep(const Travel& plan, ProfileSink& sink, ScanTally& tally) {
  const auto axis = static_cast<std::uint32_t>(file_.axis);
  const auto laser = static_cast<std::uint32_t>(file_.laser);
  Status off = unless_stopped(*stopped_, file_);  // a camera may have taken seconds to start
  off = off ? stage_.move({axis, plan.from, file_.speed, false}) : off;
  off = off ? unless_stopped(*stopped_, file_) : off;
  off = off ? stage_.set_laser(laser, file_.laser_power) : off;
  off = off ? unless_stopped(*stopped_, file_) : off;
  off = off ? stage_.move({axis, plan.to, plan.speed, true}) : off;
  if (!off) {
    return off;
  }
  StageWatch watch(stage_, axis, plan.time_of_way());
  StripeStream stripes(camera_, extractor_.options(),
                       [this](const Frame& frame) { return check_frame(frame); });
  RowCount rows(file_.start, file_.step, file_.rows);
  std::uint64_t unsure = 0;  // since the last row whose place was known
  double position = plan.from;
  while (!rows.ends_within(0.5, position)) {
    if (Status may = unless_stopped(*stopped_, file_); !may) {
      return may;
    }
    Result<StreamedStripe> seen = stripes.next();
    if (!seen) {
      return std::unexpected(seen.error());
    }
    const std::optional<PositionTrack::Place> there = watch.track().at(seen->timestamp_ns);
    if (!there && !watch.track().closed_before(seen->timestamp_ns)) {
      continue;  // taken before it moved
    }
    if (!there) {
      if (stopped_->load()) {
        continue;
      }
      const double rest = watch.track().last().value_or(position);
      if (rows.any() && rows.ends_within(1.5, rest)) {
        position = rest;  // the axis ends where the scan does
        break;
      }
      const Status told = watch.finish();
      return !told ? told
                   : stopped_short(file_, triangulator_->calibration().motion.kind != MotionKind::kLinear,
                                   rest);
    }
    if (there->sigma > kSureSteps * file_.step) {
      unsure += there->position < rows.end() + 0.5 * file_.step ? 1 : 0;
      continue;
    }
    position = there->position;
    const std::optional<RowCount::Placed> placed = rows.place(seen->id, position);
    if (!placed) {
      continue;
    }
    tally.profiles_dropped += placed->missed;
    unsure = 0;  // a gap in the numbers: counted
    pitch_->add(placed->row, seen->timestamp_ns, position);
    SweptRow swept{placed->row, seen->timestamp_ns, position, std::move(seen->stripe)};
    if (window_) {
      if (Status handed = hand_on(std::move(swept), sink, tally); !handed) {
        return handed;
      }
      continue;
    }
    waiting_.push_back(std::move(swept));
    if (pitch_->is_known()) {
      if (Status begun = begin(sink, tally); !begun) {
        return begun;
      }
    }
  }
  // Those whose place is not known are among those that are missing, but where the stage came to rest.
  tally.profiles_dropped += rows.any() ? std::max(unsure, rows.missed_until(position, pitch_->value())) : 0;
  if (!rows.any()) {
    return fail(ErrorKind::kDevice,
                unsure > 0 ? "nobody knows where the stage was: its answers come too late"
                           : "no frame came while the stage passed the scan",
                file_.camera, "scan more slowly, or relieve this machine of other work");
  }
  // What it needs to come to rest behind the last row.
  watch.track().wait_closed(plan.time_to_rest(rows.end()));
  return watch.finish();
}

}  // namespace dubsar
