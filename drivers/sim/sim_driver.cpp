// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// sim: a tablet in front of a simulated triangulation scanner. What goes through the interface is what a
// device would know: profiles and nominal positions. The truth goes to files, where truth=DIR asks for it.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <optional>
#include <thread>

#include "core/mesh.h"
#include "drivers/driver.h"
#include "drivers/plugin.h"
#include "drivers/sim/sim_options.h"
#include "drivers/sim/truth_files.h"
#include "formats/mesh_io.h"

using namespace dubsar;

struct dubsar_device {
  sim::SimStation station;
  std::optional<sim_driver::TruthFiles> truth;
  sim_driver::SimOptions options;
  std::string name;
  int scans = 0;
  int moves = 0;
  std::atomic<bool> stopped = false;  ///< set by stop(), from any thread
};

namespace {

/// A mesh whose middle is farther than this from its origin is moved there: the simulated hands turn the
/// tablet about its centre.
constexpr float kOffCentreMm = 1.0F;

Result<sim::SimTablet> tablet_from_file(const std::filesystem::path& path) {
  Result<Mesh> mesh = read_mesh(path);
  if (!mesh) {
    return std::unexpected(mesh.error());
  }
  Eigen::Vector3f low = mesh->positions.front();
  Eigen::Vector3f high = low;
  for (const Eigen::Vector3f& p : mesh->positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  if (const Eigen::Vector3f middle = 0.5F * (low + high); middle.norm() > kOffCentreMm) {
    for (Eigen::Vector3f& p : mesh->positions) {
      p -= middle;
    }
  }
  mesh->normals = vertex_normals(*mesh);
  sim::SimTablet tablet;
  const std::size_t vertices = mesh->positions.size();
  tablet.mesh = std::move(*mesh);
  tablet.albedo.assign(vertices, 0.6F);
  tablet.kinds.assign(vertices, sim::SurfaceKind::kBody);
  tablet.wedge_of.assign(vertices, -1);
  return tablet;
}

std::int32_t describe_options(dubsar_setting_callback callback, void* user, dubsar_error* /*error*/) {
  return plugin::describe(sim_driver::option_rows(), callback, user);
}

std::int32_t discover(dubsar_device_callback callback, void* user, dubsar_error* /*error*/) {
  const dubsar_device_info info{sizeof info, "sim:", "a made-up tablet before a simulated scanner"};
  return callback(user, &info) != 0 ? DUBSAR_CANCELLED : DUBSAR_OK;
}

std::int32_t open(const char* locator, const dubsar_option* options, std::uint32_t count,
                  dubsar_device** device, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    if (*locator != '\0') {
      return plugin::report(error, DUBSAR_USAGE, "nothing stands between sim: and its options", locator,
                            "write sim:?seed=1");
    }
    const Result<sim_driver::SimOptions> parsed = sim_driver::parse_options({options, count});
    if (!parsed) {
      return plugin::report(error, parsed.error());
    }
    JobContext job;
    Result<sim::SimTablet> tablet = parsed->tablet_file.empty() ? sim::make_tablet(parsed->tablet, job)
                                                                : tablet_from_file(parsed->tablet_file);
    if (!tablet) {
      return plugin::report(error, tablet.error());
    }
    auto made = std::unique_ptr<dubsar_device>(
        new dubsar_device{.station = sim::SimStation(std::move(*tablet), parsed->station),
                          .truth = {},
                          .options = *parsed,
                          .name = {}});
    made->name = "sim-" + std::to_string(parsed->station.seed);
    if (!parsed->truth_folder.empty()) {
      made->truth.emplace(parsed->truth_folder, made->station);
      if (const Status begun = made->truth->begin(made->station); !begun) {
        return plugin::report(error, begun.error());
      }
    }
    *device = made.release();
    return DUBSAR_OK;
  });
}

void close(dubsar_device* device) {
  delete device;
}

std::int32_t capabilities(dubsar_device* device, dubsar_capabilities* out, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    plugin::lend(out, plugin::capabilities_of(device->station.rig()));
    return DUBSAR_OK;
  });
}

/// Waits while the motors run. The share of the way that they came.
double run_motors(dubsar_device& device) {
  using Clock = std::chrono::steady_clock;
  const std::chrono::duration<double> all(device.options.move_time_s);
  const auto start = Clock::now();
  for (;;) {
    const std::chrono::duration<double> spent = Clock::now() - start;
    if (spent >= all) {
      return 1.0;
    }
    if (device.stopped) {
      return spent / all;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

std::int32_t place(dubsar_device* device, const dubsar_placement* asked, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    const Placement placement = plugin::placement_from(asked);
    if (const Status allowed = device->station.check(placement); !allowed) {
      return plugin::report(error, allowed.error());
    }
    device->stopped = false;
    const bool fails = device->moves++ == device->options.fail_move_at;
    const double share = fails ? 0.5 : run_motors(*device);
    if (const Status moved = device->station.move(placement, share); !moved) {
      return plugin::report(error, moved.error());
    }
    if (fails) {
      return plugin::report(error, DUBSAR_DEVICE, "a motor does not answer, half way there", device->name,
                            "see what holds it up, then give the same command again");
    }
    return share < 1.0 ? plugin::report(error, DUBSAR_CANCELLED, "stopped on the way", device->name)
                       : std::int32_t{DUBSAR_OK};
  });
}

std::int32_t stop(dubsar_device* device, dubsar_error* /*error*/) {
  device->stopped = true;
  return DUBSAR_OK;
}

/// Another tablet of the same size, as they lie side by side in the box.
Status swap_tablet(dubsar_device& device) {
  sim::TabletOptions other = device.options.tablet;
  other.seed += 1000003;
  JobContext job;
  Result<sim::SimTablet> tablet = sim::make_tablet(other, job);
  if (!tablet) {
    return std::unexpected(tablet.error());
  }
  device.station.swap(std::move(*tablet));
  return {};
}

std::int32_t scan(dubsar_device* device, const dubsar_sink* sink, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    const sim_driver::SimOptions& options = device->options;
    if (device->scans == options.swap_at) {
      if (const Status swapped = swap_tablet(*device); !swapped) {
        return plugin::report(error, swapped.error());
      }
    }
    const bool in_the_way = device->scans >= options.intrude_at && device->scans <= options.intrude_until &&
                            (device->scans - options.intrude_at) % options.intrude_every == 0;
    if (options.intrude_at >= 0) {
      device->station.disturb(in_the_way ? options.intrude : sim::Disturbance::kNone, device->scans);
    }
    const bool breaks_off = device->scans == options.stop_at;
    RangeGrid header = device->station.empty_grid();
    if (header.rows == 0 || header.cols == 0) {
      return plugin::report(error, DUBSAR_DEVICE, "nothing of the tablet lies in the measuring volume",
                            device->name, "place the tablet or the scanner otherwise");
    }
    char name[32];
    std::snprintf(name, sizeof name, "scan_%03d", device->scans);
    header.source = name;
    header.device = device->name;
    if (device->truth) {
      if (const Status written = device->truth->add_scan(device->scans, header.source, device->station);
          !written) {
        return plugin::report(error, written.error());
      }
    }
    ++device->scans;

    const dubsar_scan_info info = plugin::scan_info_of(header);
    dubsar_scan_end end{sizeof end, DUBSAR_OK, 0, 0, 0};
    bool refused = sink->begin(sink->user, &info) != 0;
    bool broken_off = false;
    Status scanned;
    if (!refused) {
      JobContext job;
      scanned = device->station.scan(
          [&](const sim::ProfileRow& row) {
            broken_off = breaks_off && row.row >= options.stop_rows;
            if (broken_off) {
              return false;
            }
            dubsar_profile profile{};
            profile.struct_size = sizeof profile;
            profile.count = static_cast<std::uint32_t>(row.x.size());
            profile.row = row.row;
            profile.x = row.x.data();
            profile.y = row.y.data();
            profile.z = row.z.data();
            profile.valid = row.valid.data();
            profile.intensity = row.intensity.empty() ? nullptr : row.intensity.data();
            refused = sink->profile(sink->user, &profile) != 0;
            end.profiles_sent += refused ? 0 : 1;
            return !refused;
          },
          job);
    }
    if (broken_off) {
      scanned = fail(ErrorKind::kDevice, "the scanner stopped in the middle of the scan", device->name,
                     "see to its cable and power, then give the same command again");
    }
    end.code = refused ? DUBSAR_CANCELLED : scanned ? DUBSAR_OK : plugin::code_of(scanned.error().kind);
    sink->end(sink->user, &end);
    if (refused) {
      return plugin::report(error, DUBSAR_CANCELLED, "scan cancelled");
    }
    return plugin::answer(scanned, error);
  });
}

constexpr dubsar_driver kDriver = [] {
  dubsar_driver out = plugin::empty_driver();
  out.scheme = "sim";
  out.description = "a made-up tablet on a turntable before a simulated triangulation scanner";
  out.version = "1";
  out.locator_help = "";
  out.describe_options = describe_options;
  out.discover = discover;
  out.open = open;
  out.close = close;
  out.capabilities = capabilities;
  out.place = place;
  out.scan = scan;
  out.stop = stop;
  return out;
}();

}  // namespace

const dubsar_driver* dubsar_driver_entry() {
  return &kDriver;
}
