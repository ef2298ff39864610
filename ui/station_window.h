// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "core/job.h"
#include "core/pin_set.h"
#include "core/result.h"

namespace dubsar::ui {

struct StationWindowOptions {
  std::filesystem::path session;
  std::string device;  ///< URI; empty: the one used last
  std::optional<PinSet> pins;
  std::filesystem::path mesh;                    ///< looks at this mesh; no session then
  std::filesystem::path other_mesh;              ///< beside it
  std::filesystem::path script;                  ///< plays it (docs/operators/window_scripts.md)
  std::string language;                          ///< "en", "de"; empty: as chosen last
  std::function<void(const Error&)> given_up{};  ///< LiveSession::Options::given_up
  int width = 1366;
  int height = 768;
};

/// Opens the window and stays until it is closed; what runs then is stopped in good order. 0, or 1 when a
/// script waited for something in vain. Errors: kDevice without a display with OpenGL 4.1, kUsage for a bad
/// script, kBadInput for a mesh that cannot be read. Cancelling the job closes the window.
[[nodiscard]] Result<int> run_station_window(const StationWindowOptions& options, JobContext& job);

}  // namespace dubsar::ui
