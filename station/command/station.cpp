// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar station: the window. dubsar view: the same, to look at one mesh or two.

#include <memory>

#include "formats/pins_json.h"
#include "station/command/command.h"
#include "station/command/device_wait.h"
#include "station/command/option_checks.h"
#include "station/command/size_option.h"
#include "ui/station_window.h"

namespace dubsar {

namespace {

struct StationArguments {
  ui::StationWindowOptions window;
  std::string session;
  std::string mesh;
  std::string other_mesh;
  std::string script;
  std::string pins;
};

Result<int> open_station(const StationArguments& arguments, CommandContext& context) {
  ui::StationWindowOptions options = arguments.window;
  options.session = arguments.session;
  options.mesh = arguments.mesh;
  options.other_mesh = arguments.other_mesh;
  options.script = arguments.script;
  if (!arguments.pins.empty()) {
    Result<PinSet> pins = read_pins(arguments.pins);
    if (!pins) {
      return std::unexpected(pins.error());
    }
    options.pins = std::move(*pins);
  }
  show_progress(false);
  outlive_readers();
  options.given_up = [json = context.json](const Error& error) { end_without_device(error, json); };
  const DevicePatience patience = patience_with_device(context);
  const Result<int> status = ui::run_station_window(options, context.job);
  if (status && context.json) {
    CommandContext::print({{"session", arguments.session}, {"status", *status}});
  }
  return status;
}

/// What a window has, whatever it is opened for.
void add_window_options(CLI::App& verb, StationArguments& arguments) {
  verb.add_option("--script", arguments.script,
                  "play what a person would do (docs/operators/window_scripts.md)");
  verb.add_option("--language", arguments.window.language, "of the window; default: as chosen last")
      ->check(CLI::IsMember({"en", "de"}));
  verb.add_option("--width", arguments.window.width, "of the window, pixels")
      ->check(in_range(640, 16384))
      ->capture_default_str();
  verb.add_option("--height", arguments.window.height, "of the window, pixels")
      ->check(in_range(480, 16384))
      ->capture_default_str();
  verb.fallthrough();
}

}  // namespace

void add_view(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand("view", "Look at a mesh, or at two side by side");
  const auto arguments = std::make_shared<StationArguments>();
  verb->add_option("mesh", arguments->mesh, "PLY, OBJ, STL or GLB")->required();
  verb->add_option("other", arguments->other_mesh, "the one beside it, to the same scale");
  add_window_options(*verb, *arguments);
  verb->callback([&chosen, arguments] {
    chosen = [arguments](CommandContext& c) { return open_station(*arguments, c); };
  });
}

void add_station(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand("station", "The window: scan a tablet, or look at a mesh");
  const auto arguments = std::make_shared<StationArguments>();
  verb->add_option("--session", arguments->session, "folder of the session; gone on with when it is there")
      ->default_val("session");
  verb->add_option("--device", arguments->window.device,
                   "URI of the scanner; without it the session's own, or the one used last");
  verb->add_option("--pins", arguments->pins, "the operator's pins (pins.json)");
  verb->add_option("--mesh", arguments->mesh, "look at this mesh instead");
  add_window_options(*verb, *arguments);
  verb->callback([&chosen, arguments] {
    chosen = [arguments](CommandContext& c) { return open_station(*arguments, c); };
  });
}

}  // namespace dubsar
