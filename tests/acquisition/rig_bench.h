// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "core/mesh_query.h"
#include "drivers/device.h"
#include "drivers/driver.h"
#include "drivers/plugin.h"
#include "sim/frame_renderer.h"
#include "sim/frame_rig.h"
#include "sim/scene.h"

namespace dubsar::test {

/// A simulated camera and stage behind the driver interface, that share one bench: what the camera sees
/// follows where the stage stands and whether its laser is on.
struct RigBench {
  RigCalibration truth;
  const sim::Scene* scene = nullptr;
  std::function<GrayImage(const RigBench&)> look;  ///< in place of the scene
  std::function<void()> when_started;              ///< the camera's stream was asked for
  sim::FrameOptions optics;
  std::string serial = "SIM-CAMERA";
  double position = 0;
  double laser = 0;
  double limit = 10;
  int cut = 0;               ///< rows that the camera leaves away at the lower edge
  int gone_after = 1 << 30;  ///< frames until the camera is unplugged
  bool stuck = false;
  bool says_it_moves = false;  ///< for ever
  bool mute = false;           ///< tells of no axis
  bool can_home = false;
  double speed = 0;               ///< that the last move was asked for
  std::vector<double> sent;       ///< where it was sent
  double whole_step = 0;          ///< between which it cannot stand; 0: anywhere
  bool burns_on = false;          ///< the controller obeys no more once its laser is lit
  bool lights_unsaid = false;     ///< it lights its laser and does not answer
  bool deaf = false;              ///< it does not answer to a stop
  std::atomic<bool> far = false;  ///< a move ends by nothing but a stop
  int stale = 0;                  ///< frames of long ago that the camera still holds
  std::mutex line;                ///< of laser and asked: a stop comes from another thread
  std::string asked;              ///< of the stage: L, D (laser lit, dark), S (stop), E (emergency stop)
  std::uint64_t frames = 0;
  GrayImage frame;
  bool settable = false;  ///< the camera has an exposure to set
  double exposure_us = 2000;
  std::uint32_t offset_x = 0;  ///< that it says its region has
  /// Settings of the part that it sends: width_px, height_px, offset_x_px, offset_y_px; empty: all, always.
  std::map<std::string, int> part;
  std::vector<double> lit_us, unlit_us;  ///< exposures of the frames, by the laser
};

/// A camera of 256 x 200 pixels that sees 6.25 mm of `scene`, calibrated on the first of January.
inline void set_up_small(RigBench& bench, const sim::Scene& scene) {
  sim::FrameRigOptions size;
  size.width = 256;
  size.height = 200;
  size.field_mm = 6.25;
  bench.truth = sim::frame_rig(size);
  bench.truth.made_at = "2026-01-01T00:00:00Z";
  bench.scene = &scene;
  bench.optics.ambient_signal = 0.05;
}

inline RigBench& bench_of(dubsar_device* device) {
  return *reinterpret_cast<RigBench*>(device);
}

inline std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

inline const dubsar_driver& camera_driver() {
  static const dubsar_driver driver = [] {
    dubsar_driver out = plugin::empty_driver();
    out.scheme = "bench_camera";
    out.close = [](dubsar_device*) {};
    out.capabilities = [](dubsar_device* device, dubsar_capabilities* to, dubsar_error*) -> std::int32_t {
      dubsar_capabilities c{};
      c.struct_size = sizeof c;
      c.flags = DUBSAR_YIELDS_FRAMES | DUBSAR_YIELDS_NO_SCANS;
      c.calibration_age_days = -1;
      plugin::copy_text(c.serial, bench_of(device).serial);
      plugin::lend(to, c);
      return DUBSAR_OK;
    };
    out.describe_settings = [](dubsar_device* device, dubsar_setting_callback callback, void* user,
                               dubsar_error*) -> std::int32_t {
      for (const auto& [key, value] : bench_of(device).part) {
        dubsar_setting of_part{};
        of_part.struct_size = sizeof of_part;
        of_part.type = DUBSAR_TYPE_INTEGER;
        of_part.flags = DUBSAR_SETTING_READABLE | DUBSAR_SETTING_WRITABLE;
        of_part.key = key.c_str();
        of_part.help = "";
        const CameraModel& all = bench_of(device).truth.camera;
        of_part.maximum = key == "width_px" || key == "offset_x_px" ? all.width : all.height;
        if (callback(user, &of_part) != 0) {
          return DUBSAR_CANCELLED;
        }
      }
      if (!bench_of(device).settable) {
        return DUBSAR_OK;
      }
      const dubsar_setting exposure{sizeof exposure,
                                    DUBSAR_TYPE_NUMBER,
                                    DUBSAR_SETTING_READABLE | DUBSAR_SETTING_WRITABLE,
                                    "exposure_us",
                                    "",
                                    "us",
                                    nullptr,
                                    1,
                                    1e6,
                                    0};
      return callback(user, &exposure) == 0 ? DUBSAR_OK : DUBSAR_CANCELLED;
    };
    out.get_setting = [](dubsar_device* device, const char*, dubsar_value* to,
                         dubsar_error*) -> std::int32_t {
      dubsar_value value{};
      value.struct_size = sizeof value;
      value.type = DUBSAR_TYPE_NUMBER;
      value.number = bench_of(device).exposure_us;
      plugin::lend(to, value);
      return DUBSAR_OK;
    };
    out.set_setting = [](dubsar_device* device, const char* key, const dubsar_value* value,
                         dubsar_error*) -> std::int32_t {
      if (const auto of_part = bench_of(device).part.find(key); of_part != bench_of(device).part.end()) {
        of_part->second = static_cast<int>(value->integer);
        return DUBSAR_OK;
      }
      bench_of(device).exposure_us = value->number;
      return DUBSAR_OK;
    };
    out.start_frames = [](dubsar_device* device, std::uint32_t, dubsar_error*) -> std::int32_t {
      if (bench_of(device).when_started) {
        bench_of(device).when_started();
      }
      return DUBSAR_OK;
    };
    out.next_frame = [](dubsar_device* device, std::uint32_t, dubsar_frame* to,
                        dubsar_error* error) -> std::int32_t {
      RigBench& bench = bench_of(device);
      if (static_cast<int>(bench.frames) >= bench.gone_after) {
        return plugin::report(error, DUBSAR_DEVICE, "the camera is gone", "bench", "plug it in");
      }
      ++bench.frames;
      const bool stale = bench.stale > 0;
      if (stale) {
        --bench.stale;
        bench.frame = GrayImage(bench.truth.camera.width, bench.truth.camera.height);
      } else if (bench.look) {
        bench.frame = bench.look(bench);
      } else {
        const RigidTransform tablet_from_camera =
            bench.truth.scanner_from_camera() * bench.truth.motion.zero_from_camera(bench.position);
        const sim::SceneTarget target(*bench.scene, tablet_from_camera);
        bench.frame = sim::FrameRenderer(bench.truth, bench.optics)
                          .render(target, bench.laser > 0, bench.position, bench.frames);
      }
      if (!bench.part.empty()) {
        GrayImage part(bench.part["width_px"], bench.part["height_px"]);
        for (int row = 0; row < part.height; ++row) {
          for (int col = 0; col < part.width; ++col) {
            part.pixels[part.index(col, row)] =
                bench.frame.at(col + bench.part["offset_x_px"], row + bench.part["offset_y_px"]);
          }
        }
        bench.frame = std::move(part);
      }
      dubsar_frame frame{};
      frame.struct_size = sizeof frame;
      frame.flags = DUBSAR_FRAME_EXPOSED;
      frame.lease = bench.frames;
      frame.id = bench.frames;
      frame.timestamp_ns = stale ? 1 : now_ns();
      frame.pixels = bench.frame.pixels.data();
      frame.width = static_cast<std::uint32_t>(bench.frame.width);
      frame.height = static_cast<std::uint32_t>(bench.frame.height - bench.cut);
      frame.stride_bytes = frame.width;
      frame.size_bytes = static_cast<std::uint64_t>(frame.width) * frame.height;
      frame.pixel_format = DUBSAR_PIXEL_MONO8;
      frame.offset_x = bench.part.empty() ? bench.offset_x : bench.part["offset_x_px"];
      frame.offset_y = bench.part.empty() ? 0 : bench.part["offset_y_px"];
      (bench.laser > 0 ? bench.lit_us : bench.unlit_us).push_back(bench.exposure_us);
      plugin::lend(to, frame);
      return DUBSAR_OK;
    };
    out.release_frame = [](dubsar_device*, std::uint64_t) {};
    out.stop_frames = [](dubsar_device*, dubsar_error*) -> std::int32_t { return DUBSAR_OK; };
    out.frame_counters = [](dubsar_device*, dubsar_frame_counters*, dubsar_error*) -> std::int32_t {
      return DUBSAR_OK;
    };
    return out;
  }();
  return driver;
}

inline const dubsar_driver& stage_driver() {
  static const dubsar_driver driver = [] {
    dubsar_driver out = plugin::empty_driver();
    out.scheme = "bench_stage";
    out.close = [](dubsar_device*) {};
    out.capabilities = [](dubsar_device*, dubsar_capabilities* to, dubsar_error*) -> std::int32_t {
      dubsar_capabilities c{};
      c.struct_size = sizeof c;
      c.flags = DUBSAR_IS_STAGE | DUBSAR_YIELDS_NO_SCANS;
      c.calibration_age_days = -1;
      plugin::lend(to, c);
      return DUBSAR_OK;
    };
    out.describe_axes = [](dubsar_device* device, dubsar_axis_callback callback, void* user,
                           dubsar_error*) -> std::int32_t {
      const RigBench& bench = bench_of(device);
      dubsar_axis axis{};
      axis.struct_size = sizeof axis;
      axis.kind = bench.truth.motion.kind == MotionKind::kLinear ? DUBSAR_AXIS_LINEAR : DUBSAR_AXIS_ROTARY;
      axis.name = "way";
      axis.minimum = -bench.limit;
      axis.maximum = bench.limit;
      axis.speed_maximum = 5;
      axis.resolution = 0.001;
      axis.flags = bench.can_home ? DUBSAR_AXIS_CAN_HOME : 0;
      return callback(user, &axis) == 0 ? DUBSAR_OK : DUBSAR_CANCELLED;
    };
    out.home = [](dubsar_device*, dubsar_error*) -> std::int32_t { return DUBSAR_OK; };
    out.move = [](dubsar_device* device, const dubsar_move* move, dubsar_error*) -> std::int32_t {
      RigBench& bench = bench_of(device);
      bench.sent.push_back(move->position);
      if (bench.far) {
        while (bench.far) {
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        return DUBSAR_CANCELLED;
      }
      const double step = bench.whole_step;
      const double there = step > 0 ? step * std::round(move->position / step) : move->position;
      bench.position = bench.stuck ? bench.position : there;
      bench.speed = move->speed;
      return DUBSAR_OK;
    };
    out.read_motion = [](dubsar_device* device, dubsar_motion* to, dubsar_error*) -> std::int32_t {
      const RigBench& bench = bench_of(device);
      dubsar_motion motion{};
      motion.struct_size = sizeof motion;
      motion.flags = DUBSAR_MOTION_HOMED | (bench.says_it_moves ? DUBSAR_MOTION_MOVING : 0U);
      motion.timestamp_ns = now_ns();
      motion.axis_count = bench.mute ? 0 : 1;
      motion.laser_count = 1;
      motion.position[0] = bench.position;
      motion.laser[0] = bench.laser;
      plugin::lend(to, motion);
      return DUBSAR_OK;
    };
    out.set_laser = [](dubsar_device* device, std::uint32_t, double power,
                       dubsar_error* error) -> std::int32_t {
      const std::scoped_lock lock(bench_of(device).line);
      if (bench_of(device).burns_on && bench_of(device).laser > 0 && power == 0) {
        return plugin::report(error, DUBSAR_DEVICE, "the controller does not answer", "bench",
                              "see to its cable");
      }
      bench_of(device).laser = power;
      bench_of(device).asked += power > 0 ? 'L' : 'D';
      if (bench_of(device).lights_unsaid && power > 0) {
        return plugin::report(error, DUBSAR_DEVICE, "the controller does not answer", "bench",
                              "see to its cable");
      }
      return DUBSAR_OK;
    };
    out.stop = [](dubsar_device* device, dubsar_error* error) -> std::int32_t {
      const std::scoped_lock lock(bench_of(device).line);
      bench_of(device).far = false;  // whoever waits for its end is let go
      if (bench_of(device).deaf || (bench_of(device).burns_on && bench_of(device).laser > 0)) {
        return plugin::report(error, DUBSAR_DEVICE, "the controller does not answer", "bench",
                              "see to its cable");
      }
      bench_of(device).laser = 0;
      bench_of(device).asked += 'S';
      return DUBSAR_OK;
    };
    out.emergency_stop = [](dubsar_device* device, dubsar_error* error) -> std::int32_t {
      const std::scoped_lock lock(bench_of(device).line);
      bench_of(device).far = false;
      if (bench_of(device).deaf) {
        return plugin::report(error, DUBSAR_DEVICE, "the controller does not answer", "bench",
                              "see to its cable");
      }
      bench_of(device).laser = 0;
      bench_of(device).asked += 'E';
      return DUBSAR_OK;
    };
    return out;
  }();
  return driver;
}

inline Device camera_of(RigBench& bench) {
  return {&camera_driver(), reinterpret_cast<dubsar_device*>(&bench), "bench_camera:"};
}
inline Device stage_of(RigBench& bench) {
  return {&stage_driver(), reinterpret_cast<dubsar_device*>(&bench), "bench_stage:"};
}

}  // namespace dubsar::test
