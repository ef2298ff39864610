// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>

namespace dubsar::ui {

/// Which tablet and which scanner, for whoever comes to a window that another has left: "BM 15285 – box-2 –
/// rig:bench.toml". What is empty is left out.
[[nodiscard]] std::string window_title(const std::string& museum_number, const std::filesystem::path& session,
                                       const std::string& device);

/// Whether scans of this device are made up.
[[nodiscard]] bool is_simulated(const std::string& device);

}  // namespace dubsar::ui
