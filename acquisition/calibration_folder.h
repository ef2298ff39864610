// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "acquisition/calibration.h"
#include "core/job.h"
#include "formats/calibration_set.h"

namespace dubsar {

/// The pictures of a calibration, looked at.
struct CalibrationPictures {
  BoardSpec board;
  std::vector<CalibrationView> views;
  std::vector<std::string> left_out;  ///< pictures without a board, and why
};

/// Reads the pictures that `set` names in `folder`, finds the board in each and the stripe where there is
/// one. A picture without a board is left out and told; a file that is not there or no picture is an error.
/// Errors: kBadInput, kUsage (the board's name), kCancelled.
[[nodiscard]] Result<CalibrationPictures> look_at_pictures(const std::filesystem::path& folder,
                                                           const CalibrationSet& set, const JobContext& job);

/// The set for a folder without a calibration.toml: every picture in it shows the board, in name order.
[[nodiscard]] Result<CalibrationSet> set_of_folder(const std::filesystem::path& folder,
                                                   const std::string& board);

/// "pose_07_laser.png": `stem`, two digits or more, and `rest`.
[[nodiscard]] std::string numbered_picture(const char* stem, std::size_t number, const char* rest);

/// The first number from `from` on of which no picture lies in `folder`: a list may have been written by
/// hand, or have lost some of its lines, and what is taken next is written over nothing.
[[nodiscard]] std::size_t free_picture_number(const std::filesystem::path& folder, const char* stem,
                                              std::size_t from);

/// The stripe in a picture with the laser on, the same light without it (or nothing) subtracted: image
/// points.
[[nodiscard]] std::vector<Eigen::Vector2d> stripe_on_board(const CalibrationSet& set, const GrayView& on,
                                                           const GrayView& off);

}  // namespace dubsar
