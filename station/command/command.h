// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <nlohmann/json.hpp>

#include "core/job.h"
#include "core/result.h"
#include "station/command/terminal.h"

namespace dubsar {

/// What every verb works with. A verb returns the exit status of the contract (0 done, 1 fell short) or an
/// Error.
struct CommandContext {
  bool json = false;  ///< one JSON object on standard output and nothing else there
  JobContext job{terminal_progress()};

  /// Prints the verb's one JSON object.
  static void print(const nlohmann::ordered_json& object);
};

/// What --json says of an error.
[[nodiscard]] inline nlohmann::ordered_json error_json(const Error& error) {
  return {{"error", {{"what", error.what}, {"where", error.where}, {"mend", error.mend}}}};
}

using Action = std::function<Result<int>(CommandContext&)>;

/// Each registers its verb with the parser and, when the verb is chosen, sets `chosen`.
void add_drivers(CLI::App& app, Action& chosen);
void add_simulate(CLI::App& app, Action& chosen);
void add_calibrate(CLI::App& app, Action& chosen);
void add_scan(CLI::App& app, Action& chosen);
void add_register(CLI::App& app, Action& chosen);
void add_plan(CLI::App& app, Action& chosen);
void add_pins(CLI::App& app, Action& chosen);
void add_stitch(CLI::App& app, Action& chosen);
void add_analyze(CLI::App& app, Action& chosen);
void add_view(CLI::App& app, Action& chosen);
void add_wedges(CLI::App& app, Action& chosen);
void add_mesh(CLI::App& app, Action& chosen);
void add_search(CLI::App& app, Action& chosen);
void add_verify(CLI::App& app, Action& chosen);
void add_export(CLI::App& app, Action& chosen);
void add_session(CLI::App& app, Action& chosen);
void add_station(CLI::App& app, Action& chosen);
void add_bench(CLI::App& app, Action& chosen);
void add_reference(CLI::App& app, Action& chosen);

}  // namespace dubsar
