// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the engine says, kept for a skin to read.
#include <algorithm>
#include <cmath>

#include "acquisition/rig_scan.h"
#include "core/tablet_sides.h"
#include "station/calibration_age.h"
#include "station/device_patience.h"
#include "station/live_session.h"

namespace dubsar {

namespace {

/// Samples of a scan that are kept to be pointed at: a few megabytes.
constexpr double kShownSamples = 250000;

std::string remark_line(const LiveScan& scan) {
  const std::string name = scan.file.empty() ? std::string() : " (" + scan.file + ")";
  return "scan " + std::to_string(scan.id) + name + ": " + scan.remark;
}

}  // namespace

LiveState LiveSession::state() const {
  const std::scoped_lock lock(mutex_);
  LiveState out = state_;
  const auto silent = device_told_ ? silent_device(*device_told_, kSilentAfter) : std::nullopt;
  if (out.care && out.care->last) {  // the window may stand open over night
    out.care->age_days = days_since(out.care->last->when);
  }
  if (out.checklist) {
    out.checklist->calibration_age_days = calibration_age_now(*out.checklist, last_scan_);
  }
  out.silence = silent ? std::optional(silence_of(*silent)) : std::nullopt;
  return out;
}

void LiveSession::progress(std::string_view stage, double fraction) {
  {
    const std::scoped_lock lock(mutex_);
    state_.stage = stage;
    state_.fraction = fraction;
  }
  changed();
}

LiveScan& LiveSession::scan_of(int id) {
  const auto at = std::ranges::lower_bound(state_.scans, id, {}, &LiveScan::id);
  if (at != state_.scans.end() && at->id == id) {
    return *at;
  }
  LiveScan scan;
  scan.id = id;
  return *state_.scans.insert(at, std::move(scan));
}

void LiveSession::follow(const std::vector<ScanPose>& poses) {
  for (LiveScan& scan : state_.scans) {
    const auto pose = std::ranges::find(poses, scan.id, &ScanPose::id);
    if (pose != poses.end()) {
      scan.pose = *pose;
      scan.dropped = scan.set_aside = false;
      scan.note.clear();
    }
  }
}

void LiveSession::show_grid(int id, const RangeGrid& measured, const RangeGrid& grid,
                            const SampleFlags& flags) {
  const int stride =
      std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(grid.size()) / kShownSamples))));
  auto thin = std::make_shared<RangeGrid>(decimated(grid, stride));
  SampleFlags thin_flags;
  if (flags.size() == grid.size()) {
    thin_flags.reserve(thin->size());
    for (int r = 0; r < grid.rows; r += stride) {
      for (int c = 0; c < grid.cols; c += stride) {
        thin_flags.push_back(flags[grid.index(r, c)]);
      }
    }
  }
  auto picture = std::make_shared<const GridPicture>(picture_of(*thin, thin_flags));
  std::shared_ptr<const RangeGrid> with_pins = thin;
  if (&measured != &grid && measured.size() == grid.size()) {
    with_pins = std::make_shared<const RangeGrid>(decimated(measured, stride));
  }
  {
    const std::scoped_lock lock(mutex_);
    LiveScan& scan = scan_of(id);
    scan.measured = std::move(with_pins);
    scan.grid = std::move(thin);
    scan.picture = std::move(picture);
  }
  changed();
}

void LiveSession::show_model(std::shared_ptr<const Mesh> mesh, std::shared_ptr<const ColouredPoints> red,
                             const RigidTransform& tablet_from_model) {
  const auto face_of = [&](const Eigen::Vector3f& normal) {
    const Eigen::Vector3d n = tablet_from_model.rotation * normal.cast<double>();
    std::size_t best = 0;
    for (std::size_t face = 1; face < kFaceCount; ++face) {
      const auto along = [&](std::size_t f) { return side_axes(static_cast<Face>(f)).normal.dot(n); };
      best = along(face) > along(best) ? face : best;
    }
    return best;
  };
  std::array<double, kFaceCount> seen{};
  for (const auto& [a, b, c] : mesh->faces) {
    const auto& p = mesh->positions;
    const Eigen::Vector3f area = 0.5F * (p[b] - p[a]).cross(p[c] - p[a]);
    seen[face_of(area)] += static_cast<double>(area.norm());
  }
  std::array<int, kFaceCount> red_points{};
  for (std::size_t k = 0; red && k < red->normals.size(); ++k) {
    if (k >= red->colours.size() || red->colours[k] == kRedOfSparse) {
      ++red_points[face_of(red->normals[k])];
    }
  }
  const std::scoped_lock lock(mutex_);
  state_.mesh = std::move(mesh);
  state_.red = std::move(red);
  state_.tablet_from_model = tablet_from_model;
  state_.seen_mm2 = seen;
  state_.red_points = red_points;
  ++state_.model_number;
}

void LiveSession::hear(const Event& event) {
  if (const auto* profile = std::get_if<ProfileArrived>(&event)) {
    const auto came = std::chrono::steady_clock::now();
    bool is_news = false;
    {
      const std::scoped_lock lock(mutex_);
      growing_number_ += profile->row < growing_.rows || growing_.cols != profile->grid->cols ? 1 : 0;
      growing_.append(*profile->grid, *profile->flags, profile->row);
      is_news = !unseen_since_ || state_.phase != LivePhase::kScanning;
      unseen_since_ = unseen_since_.value_or(came);
      state_.phase = LivePhase::kScanning;
      camera_.reset();
      state_.profiles = profile->row + 1;
    }
    if (!is_news) {  // the skin looks at all that came meanwhile: it is woken once
      return;
    }
  } else if (const auto* model = std::get_if<ModelChanged>(&event)) {
    show_model(model->mesh, model->red, model->tablet_from_model);
  } else if (const auto* placed = std::get_if<ScanPlaced>(&event)) {
    if (placed->measured && placed->grid && placed->flags) {
      show_grid(placed->pose.id, *placed->measured, *placed->grid, *placed->flags);
    }
    const std::scoped_lock lock(mutex_);
    scan_of(placed->pose.id).file = placed->pose.file;
    follow(placed->all);
    for (const SetAside& one : placed->set_aside) {
      LiveScan& scan = scan_of(one.id);
      scan.dropped = scan.set_aside = true;
      scan.note = one.why;
      scan.pose.reset();
    }
    // The notice of what was set aside came before, and so did that of what ended the scanning.
    const bool tells_end = state_.phase == LivePhase::kFinishing && state_.error;
    if (placed->pose.status == PoseStatus::kRegistered && placed->set_aside.empty() && !tells_end) {
      state_.notice.clear();
    }
    // The scan's own remark stays until another scan comes.
    if (const LiveScan& scan = scan_of(placed->pose.id); state_.notice.empty() && !scan.remark.empty()) {
      state_.notice = remark_line(scan);
    }
    if (state_.phase == LivePhase::kWaiting) {
      state_.last_not_taken_up = placed->pose.status != PoseStatus::kRegistered;
    }
  } else {
    const std::scoped_lock lock(mutex_);
    if (const auto* pins = std::get_if<PinsKnown>(&event)) {
      state_.pins = pins->pins;
    } else if (const auto* device = std::get_if<DeviceTells>(&event)) {
      state_.panel = device->panel;
      if (state_.phase == LivePhase::kOpening) {  // it is open; the scans of the session come next
        state_.phase = LivePhase::kReading;
      }
    } else if (const auto* frame = std::get_if<CameraFrame>(&event)) {
      camera_ = frame->view;
    } else if (const auto* stored = std::get_if<ScanStored>(&event)) {
      LiveScan& scan = scan_of(stored->id);
      scan.file = stored->file;
      scan.samples = stored->samples;
      scan.remark = stored->remark;
      if (!scan.remark.empty()) {
        state_.notice = remark_line(scan);
      }
      state_.exists = true;
      // A device that nothing drives waits for the operator, or scans, while its scan is still being judged.
      if (!stored->scans_on && state_.phase != LivePhase::kWaiting && state_.phase != LivePhase::kFinishing) {
        state_.phase = LivePhase::kJudging;
      }
    } else if (const auto* obeyed = std::get_if<OperatorObeyed>(&event)) {
      follow(obeyed->all);
      for (const int id : obeyed->taken_out) {
        LiveScan& scan = scan_of(id);
        scan.pose.reset();
        scan.dropped = true;
      }
      state_.notice = obeyed->what;
      // A key for the step that is being thought over would be one for another than the operator saw.
      if (obeyed->asks_again && state_.phase == LivePhase::kWaiting) {
        state_.phase = LivePhase::kJudging;
      }
    } else if (const auto* red_map = std::get_if<RedMapChanged>(&event)) {
      state_.red_map = std::make_shared<const RedMap>(red_map->red_map);
      state_.verdict_kept = false;  // until the run has ended well
    } else if (std::holds_alternative<DeviceStarts>(event)) {
      state_.next.reset();
      state_.phase = LivePhase::kMoving;
    } else if (const auto* rests = std::get_if<DeviceRests>(&event)) {
      if (!job_->cancelled()) {  // else nothing is made of what there is
        state_.phase = LivePhase::kFinishing;
      }
      if (rests->error) {  // what came behind it, of the half scan perhaps, hides no reason
        state_.error = rests->error;
        state_.notice = rests->error->line();
      }
    } else if (const auto* next = std::get_if<NextPlacement>(&event)) {
      state_.next = next->view;
      state_.phase = LivePhase::kMoving;
    } else if (const auto* waits = std::get_if<WaitsForOperator>(&event)) {
      state_.next = waits->next;
      state_.last_not_taken_up = waits->not_taken_up;
      state_.phase = finish_asked_ ? LivePhase::kFinishing : LivePhase::kWaiting;
    } else if (const auto* notice = std::get_if<Notice>(&event)) {
      state_.notice = notice->text;
    }
  }
  changed();
}

}  // namespace dubsar
