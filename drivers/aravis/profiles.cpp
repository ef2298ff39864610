// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/aravis/profiles.h"

#include <chrono>
#include <cmath>

#include "drivers/plugin.h"

namespace dubsar::aravis {

namespace {

/// What goes through the interface while a scan runs.
class Scan {
 public:
  Scan(Camera& camera, const dubsar_sink& sink, const Scan3d& meaning)
      : camera_(camera), sink_(sink), meaning_(meaning), device_(camera.model() + " " + camera.serial()) {
    const CameraOptions& options = camera.options();
    row_mm_ = options.row_mm != 0 ? options.row_mm : meaning.axes[1].scale * meaning.unit_mm;
    end_.struct_size = sizeof end_;
  }

  bool begin() {
    dubsar_scan_info info{};
    info.struct_size = sizeof info;
    info.cols = static_cast<std::int32_t>(meaning_.width);
    info.expected_rows = static_cast<std::int32_t>(camera_.options().rows);
    // Of the columns; where the data bring x along, nobody knows before they are there.
    info.spacing_mm = meaning_.format.has[0] ? 0 : std::abs(meaning_.axes[0].scale) * meaning_.unit_mm;
    info.view.struct_size = sizeof info.view;
    info.view.direction[2] = -1;  // z points to the scanner
    info.view.motion_per_row_mm[1] = meaning_.format.has[1] ? 0 : row_mm_;
    info.device_id = device_.c_str();
    // Its profiles are timed on a clock that began when this machine did.
    info.timestamp_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(
                            std::chrono::system_clock::now().time_since_epoch())
                            .count();
    return sink_.begin(sink_.user, &info) == 0;
  }

  /// True where the rows are placed by a count that has begun elsewhere since the scan did.
  [[nodiscard]] bool has_lost_count(const Taken& frame) const {
    return frame.camera_restarted && frame.encoder && camera_.options().encoder_mm != 0;
  }

  /// True where the rows are placed by a count that does not come.
  [[nodiscard]] bool lacks_count(const Taken& frame) const {
    return !frame.encoder && camera_.options().encoder_mm != 0;
  }

  /// True where so much is lost before this frame, or its number is so far off, that the scan would be over
  /// with less than half of it.
  [[nodiscard]] bool jumps_to_the_end(const Taken& frame) const {
    const auto rows = static_cast<std::uint64_t>(camera_.options().rows);
    const auto next = static_cast<std::uint64_t>(next_row_);
    return 2 * next < rows && frame.lost * meaning_.height >= rows - next;
  }
  /// Without a row more.
  void lose_the_rest() {
    end_.profiles_dropped += static_cast<std::uint64_t>(camera_.options().rows - next_row_);
  }

  /// The rows of a block, as far as the scan goes. False when the sink has had enough.
  bool block(const Taken& frame) {
    const std::int64_t height = meaning_.height;
    next_row_ += static_cast<std::int64_t>(frame.lost) * height;
    end_.profiles_dropped += frame.lost * static_cast<std::uint64_t>(height);
    if (frame.width != meaning_.width || frame.height != meaning_.height) {
      next_row_ += height;
      end_.profiles_dropped += static_cast<std::uint64_t>(height);
      return true;
    }
    if (frame.encoder && !first_count_) {
      first_count_ = *frame.encoder;
    }
    const double encoder_mm = camera_.options().encoder_mm;
    const bool by_encoder = encoder_mm != 0 && frame.encoder;
    for (std::uint32_t row = 0; row < meaning_.height && next_row_ < camera_.options().rows;
         ++row, ++next_row_) {
      // Within a block the encoder is known of its first row alone.
      const double y =
          by_encoder
              ? (static_cast<double>(*frame.encoder) - static_cast<double>(*first_count_)) * encoder_mm +
                    row * row_mm_
              : static_cast<double>(next_row_) * row_mm_;
      read_row(meaning_, {frame.pixels, frame.size}, row, y, row_);
      dubsar_profile profile{};
      profile.struct_size = sizeof profile;
      profile.count = meaning_.width;
      profile.row = next_row_;
      profile.x = row_.x.data();
      profile.y = row_.y.data();
      profile.z = row_.z.data();
      profile.valid = row_.valid.data();
      profile.timestamp_ns = frame.timestamp_ns;
      if (frame.encoder) {
        profile.flags |= DUBSAR_PROFILE_ENCODER;
        profile.encoder = *frame.encoder;
      }
      if (sink_.profile(sink_.user, &profile) != 0) {
        return false;
      }
      ++end_.profiles_sent;
    }
    return true;
  }

  [[nodiscard]] bool whole() const { return next_row_ >= camera_.options().rows; }

  void end(const Status& status) {
    end_.code = status ? DUBSAR_OK : plugin::code_of(status.error().kind);
    sink_.end(sink_.user, &end_);
  }

 private:
  Camera& camera_;
  const dubsar_sink& sink_;
  const Scan3d& meaning_;
  std::string device_;
  double row_mm_ = 0;
  std::int64_t next_row_ = 0;
  std::optional<std::int64_t> first_count_;
  ProfileRow row_;
  dubsar_scan_end end_{};
};

Status stream_rows(Camera& camera, Scan& scan, const std::atomic<bool>& stopped) {
  const auto wait =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(camera.options().wait_s));
  Clock::time_point until = Clock::now() + wait;
  std::uint64_t retaken = camera.counters().reconnections;
  while (!scan.whole()) {
    if (stopped) {
      return fail(ErrorKind::kCancelled, "stopped in mid-scan", camera.id());
    }
    constexpr std::chrono::milliseconds kLook(100);  // for a stop, in between
    const Clock::time_point look = Clock::now() + kLook;
    const Result<std::optional<Taken>> frame =
        camera.next(Clock::now() < until ? std::min(until, look) : look);
    if (!frame) {
      return std::unexpected(frame.error());
    }
    if (!*frame) {
      // One that was taken anew has all of the time again.
      if (const std::uint64_t now = camera.counters().reconnections; now != retaken) {
        retaken = now;
        until = Clock::now() + wait;
      }
      // One that no longer answers is told apart from one that has nothing to send.
      if (Clock::now() >= until && !camera.is_doubtful()) {
        return fail(ErrorKind::kDevice, "the camera sends no profiles", camera.id(),
                    "see that its trigger or encoder runs, or give it more time with wait=");
      }
      continue;
    }
    if (scan.has_lost_count(**frame)) {
      camera.give_back((*frame)->lease);
      return fail(ErrorKind::kDevice,
                  "the camera started anew in mid-scan, and its encoder counts from elsewhere", camera.id(),
                  "see to its power supply, then scan again");
    }
    if (scan.lacks_count(**frame)) {
      camera.give_back((*frame)->lease);
      return fail(ErrorKind::kDevice, "the camera sends no count of its encoder along with its profiles",
                  camera.id(), "see that its encoder is set up, or leave count= away");
    }
    if (scan.jumps_to_the_end(**frame)) {
      camera.give_back((*frame)->lease);
      scan.lose_the_rest();
      return fail(ErrorKind::kDevice,
                  "the camera lost " + std::to_string((*frame)->lost) +
                      " frames in a row, and most of the scan with them",
                  camera.id(), "see to its cable and its network, then scan again");
    }
    const bool goes_on = scan.block(**frame);
    camera.give_back((*frame)->lease);
    if (!goes_on) {
      return fail(ErrorKind::kCancelled, "scan cancelled", camera.id());
    }
    until = Clock::now() + wait;
  }
  return {};
}

}  // namespace

Status run_scan(Camera& camera, const dubsar_sink& sink, const std::atomic<bool>& stopped) {
  if (const Status started = camera.start(0); !started) {
    return started;
  }
  const Result<Scan3d> meaning = camera.scan3d();
  const Status placed = meaning ? check_places(*meaning, camera.options().row_mm, camera.id())
                                : std::unexpected(meaning.error());
  if (!placed) {
    [[maybe_unused]] const Status said = camera.stop();  // the camera knows
    return placed;
  }
  Scan scan(camera, sink, *meaning);
  Status status;
  if (scan.begin()) {
    status = stream_rows(camera, scan, stopped);
  } else {
    status = fail(ErrorKind::kCancelled, "scan cancelled", camera.id());
  }
  const Status ended = camera.stop();
  if (!ended && (status || status.error().kind == ErrorKind::kCancelled)) {
    status = ended;
  }
  scan.end(status);
  return status;
}

}  // namespace dubsar::aravis
