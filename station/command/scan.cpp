// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar scan: the main job. Stream, flag, store, register, plan, stitch, until conclusive.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/device_uri.h"
#include "archive/html.h"
#include "core/checklist.h"
#include "core/log.h"
#include "core/number_text.h"
#include "core/units.h"
#include "formats/pins_json.h"
#include "formats/poses_json.h"
#include "formats/red_map_json.h"
#include "formats/rig_limits_json.h"
#include "station/command/command.h"
#include "station/command/device_wait.h"
#include "station/command/hand_turns.h"
#include "station/command/option_checks.h"
#include "station/command/scan_warnings.h"
#include "station/command/size_option.h"
#include "station/command/terminal.h"
#include "station/engine.h"
#include "station/not_conclusive.h"
#include "station/pin_faults.h"

namespace dubsar {

namespace {

struct ScanArguments {
  std::string device;
  std::string unit;  ///< of files, where the device's URI does not say it
  std::string session;
  std::string pins;
  std::string rig;
  std::string size;
  std::vector<std::string> settings;  ///< key=value
  bool automatic = false;
  int max_scans = 0;
};

double red_area_mm2(const RedMap& map) {
  double area = 0;
  for (const RedRegion& region : map.regions) {
    area += region.state == RegionState::kRed ? region.area_mm2 : 0.0;
  }
  return area;
}

std::ptrdiff_t red_regions(const RedMap& map) {
  return std::count_if(map.regions.begin(), map.regions.end(),
                       [](const RedRegion& region) { return region.state == RegionState::kRed; });
}

/// What an operator at the command line sees while it goes on: a line per thing that happened.
class Narrator {
 public:
  void operator()(const Event& event) {
    const std::scoped_lock lock(mutex_);
    if (const auto* stored = std::get_if<ScanStored>(&event)) {
      log_info(fmt::format("scan {} stored: {} samples{}{}", stored->id, stored->samples,
                           stored->file.empty() ? "" : " of ", stored->file));
      if (!stored->remark.empty()) {
        log_warning(fmt::format("{}: {}",
                                stored->file.empty() ? fmt::format("scan {}", stored->id) : stored->file,
                                stored->remark));
      }
    } else if (const auto* placed = std::get_if<ScanPlaced>(&event)) {
      const ScanPose& pose = placed->pose;
      log_info(fmt::format("scan {} {}{}{}", pose.id, to_string(pose.status), pose.reason.empty() ? "" : ": ",
                           pose.reason));
    } else if (const auto* obeyed = std::get_if<OperatorObeyed>(&event)) {
      log_info(obeyed->what);
    } else if (const auto* changed = std::get_if<RedMapChanged>(&event)) {
      if (const auto& gain = changed->gain; gain && gain->predicted_mm2) {
        log_info(fmt::format("scan {} cleared about {:.1f} mm2, {:.1f} were predicted", gain->scan,
                             gain->actual_mm2, *gain->predicted_mm2));
      }
      log_info(fmt::format("red: about {:.1f} mm2 in {}", red_area_mm2(changed->red_map),
                           counted(static_cast<std::size_t>(red_regions(changed->red_map)), "region")));
      for (const GroupApart& group : changed->red_map.apart) {
        if (told_.insert(group.say).second) {
          log_warning(group.say);
        }
      }
    } else if (const auto* next = std::get_if<NextPlacement>(&event)) {
      log_info(fmt::format("next: {} (about {:.1f} mm2)", next->view.say, next->view.predicted_cleared_mm2));
    } else if (const auto* notice = std::get_if<Notice>(&event)) {
      log_warning(notice->text);
      told_.insert(notice->text);
    }
  }

  /// Whether the operator has read this line already.
  [[nodiscard]] bool has_told(const Error& error) const {
    const std::scoped_lock lock(mutex_);
    return told_.contains(error.line());
  }

 private:
  mutable std::mutex mutex_;
  std::set<std::string> told_;
};

std::string verdict(const EngineResult& result) {
  const auto registered = std::count_if(result.poses.begin(), result.poses.end(), [](const ScanPose& pose) {
    return pose.status == PoseStatus::kRegistered;
  });
  const std::string scans = counted(static_cast<long long>(result.poses.size()), "scan", "scans");
  if (result.red_map.conclusive) {
    return fmt::format("conclusive after {}, {} registered{}", scans, registered,
                       out_of_reach(sum_out_of_reach(result.red_map).area_mm2));
  }
  return fmt::format("{} after {}, {} registered", not_conclusive(red_area_mm2(result.red_map)), scans,
                     registered);
}

nlohmann::ordered_json result_json(const ScanArguments& arguments, const EngineResult& result) {
  nlohmann::ordered_json timings;
  for (const StageTiming& timing : result.timings) {
    timings[timing.stage] = timing.seconds;
  }
  nlohmann::ordered_json json{{"session", arguments.session},
                              {"verdict", verdict(result)},
                              {"conclusive", result.red_map.conclusive},
                              {"scans", result.poses.size()},
                              {"mesh", result.files.mesh.string()},
                              {"report", result.files.report.string()},
                              {"checklist", result.files.checklist.string()},
                              {"red_map_picture", result.files.red_map.string()},
                              {"six_views", result.files.six_views.string()},
                              {"wedges", result.files.wedges.string()},
                              {"poses", nlohmann::ordered_json::parse(poses_to_json(result.poses))},
                              {"red_map", nlohmann::ordered_json::parse(red_map_to_json(result.red_map))},
                              {"timings_s", timings}};
  if (result.device_error) {
    json.update(error_json(*result.device_error));
  }
  return json;
}

void print_result(const EngineResult& result) {
  std::printf("%s\n", verdict(result).c_str());
  for (const auto& [name, path] :
       {std::pair{"mesh", &result.files.mesh}, std::pair{"six views", &result.files.six_views},
        std::pair{"red map", &result.files.red_map}, std::pair{"report", &result.files.report},
        std::pair{"checklist", &result.files.checklist}, std::pair{"wedges", &result.files.wedges}}) {
    if (!path->empty()) {
      std::printf("  %-10s %s\n", name, path->c_str());
    }
  }
  for (const GroupApart& group : result.red_map.apart) {
    std::printf("  apart      %s\n", group.say.c_str());
  }
  for (const NextView& view : result.red_map.next) {
    if (!result.red_map.conclusive) {
      std::printf("  next       %s (about %.1f mm2)\n", view.say.c_str(), view.predicted_cleared_mm2);
      break;
    }
  }
}

/// The device with `?unit=`.
Result<std::string> device_in(const std::string& device, const std::string& unit) {
  Result<DeviceUri> uri = parse_device_uri(device);
  if (unit.empty() || !uri) {
    return uri ? Result<std::string>(device) : std::unexpected(uri.error());
  }
  if (uri->scheme != "replay") {
    return fail(ErrorKind::kUsage, "--unit is of files: " + uri->scheme + ": gives millimetres", device,
                "leave it out");
  }
  const auto said = std::ranges::find(uri->options, "unit", [](const auto& option) { return option.first; });
  if (said == uri->options.end()) {
    uri->options.emplace_back("unit", unit);
  } else if (said->second != unit) {
    return fail(ErrorKind::kUsage, "--unit " + unit + " contradicts unit=" + said->second, device,
                "say one of them");
  }
  return uri->text();
}

/// Of scans that are not there yet; of those that were taken out there is nothing to say.
void warn_of_tips(const PinSet& pins, const std::vector<ScanPose>& poses, const std::string& file) {
  int highest = -1;
  for (const ScanPose& pose : poses) {
    highest = std::max(highest, pose.id);
  }
  std::vector<int> ids;
  for (const auto& [id, tips] : pins.tips) {
    if (id <= highest) {
      ids.push_back(id);
    }
  }
  if (const auto fault = tips_of_no_scan(pins, ids, file)) {
    log_warning(fault->line());
  }
}

Result<int> scan(const ScanArguments& arguments, CommandContext& context) {
  EngineOptions options;
  Result<std::string> device = device_in(arguments.device, arguments.unit);
  if (!device) {
    return std::unexpected(device.error());
  }
  options.device = std::move(*device);
  options.session = arguments.session;
  options.automatic = arguments.automatic;
  options.max_scans = arguments.max_scans;
  options.keep_half_scan = true;  // whatever ends the command: a tablet is not laid there twice for nothing
  if (!arguments.pins.empty()) {
    Result<PinSet> pins = read_pins(arguments.pins);
    if (!pins) {
      return std::unexpected(pins.error());
    }
    options.pins = std::move(*pins);
  }
  for (const std::string& pair : arguments.settings) {
    const std::size_t equals = pair.find('=');
    if (equals == 0 || equals == std::string::npos) {
      return fail(ErrorKind::kUsage, "'" + pair + "' sets nothing", "--set",
                  "write key=value, such as exposure_us=800");
    }
    put_word(options.settings, pair.substr(0, equals), pair.substr(equals + 1));
  }
  if (!arguments.rig.empty()) {
    Result<RigLimits> limits = read_rig_limits(arguments.rig);
    if (!limits) {
      return std::unexpected(limits.error());
    }
    options.limits = *limits;
    options.limits_file = arguments.rig;
  }
  if (!arguments.size.empty()) {
    const Result<Eigen::Vector3d> size = parse_size_mm(arguments.size);
    if (!size) {
      return std::unexpected(size.error());
    }
    options.size_mm = *size;
  }
  const std::optional<PinSet> pins = options.pins;
  show_progress(false);
  outlive_readers();
  Narrator narrator;
  const DevicePatience patience = patience_with_device(context);
  HandTurns* by_hand = nullptr;
  Engine engine(std::move(options), [&](const Event& event) {
    if (by_hand == nullptr || !by_hand->hear(event)) {
      narrator(event);
    }
  });
  HandTurns hand_turns(engine, arguments.session, context.job);
  by_hand = &hand_turns;
  const Result<EngineResult> result = engine.run(context.job);
  if (!result) {
    if (!narrator.has_told(result.error())) {
      return std::unexpected(result.error());
    }
    if (context.json) {
      CommandContext::print(error_json(result.error()));
    }
    return exit_status(result.error().kind);
  }
  log_scan_warnings(result->checklist.warnings);
  if (pins) {
    warn_of_tips(*pins, result->poses, arguments.pins);
  }
  if (context.json) {
    CommandContext::print(result_json(arguments, *result));
  } else {
    print_result(*result);
  }
  if (result->device_error) {
    if (!narrator.has_told(*result->device_error)) {
      log_error(result->device_error->line());
    }
    return exit_status(result->device_error->kind);
  }
  return result->red_map.conclusive ? 0 : 1;
}

}  // namespace

void add_scan(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand("scan", "The main job: scan until conclusive; status 1 when it is not");
  const auto arguments = std::make_shared<ScanArguments>();
  verb->add_option("--device", arguments->device,
                   "URI of the device: sim:, replay:PATH, … (see dubsar drivers)")
      ->required();
  verb->add_option("--unit", arguments->unit,
                   "what the numbers in the files of replay: are, as ?unit= there; default: each file's own "
                   "word, else mm")
      ->check(CLI::IsMember(std::vector<std::string>(kLengthUnits.begin(), kLengthUnits.end())));
  verb->add_option("--session", arguments->session, "folder of the session; gone on with when it is there")
      ->default_val("session");
  verb->add_option("--pins", arguments->pins, "the operator's pins (pins.json)");
  verb->add_option("--rig", arguments->rig,
                   "a rig file: narrower limits for the motors (docs/formats/rig.md)");
  verb->add_option("--size", arguments->size,
                   "of the tablet, WxHxT in mm: what the motors keep clear of before it is seen");
  verb->add_option("--set", arguments->settings,
                   "key=value of the open device, such as exposure_us=800; kept with the session");
  verb->add_flag(
      "--auto", arguments->automatic,
      "drive the rig, or ask for hand turns, until conclusive; at each hand turn nothing moves before "
      "Enter, and where standard input is no terminal the scanning ends, with status 1");
  verb->add_option("--max-scans", arguments->max_scans,
                   "of the whole session; default: 40 with --auto, else no limit")
      ->check(in_range(1, 100000));
  verb->fallthrough();
  verb->callback(
      [&chosen, arguments] { chosen = [arguments](CommandContext& c) { return scan(*arguments, c); }; });
}

}  // namespace dubsar
