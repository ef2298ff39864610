// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/calibration_folder.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "acquisition/stripe_points.h"
#include "formats/gray_file.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

Result<std::vector<Eigen::Vector2d>> stripe_in(const fs::path& folder, const CalibrationSet& set,
                                               const CalibrationSet::Pose& pose, const BoardView& board) {
  const Result<GrayImage> on = read_gray(folder / pose.laser);
  if (!on) {
    return std::unexpected(on.error());
  }
  GrayImage off;
  if (!pose.dark.empty()) {
    Result<GrayImage> read = read_gray(folder / pose.dark);
    if (!read) {
      return std::unexpected(read.error());
    }
    off = std::move(*read);
  }
  if (on->width != board.width || on->height != board.height ||
      (!pose.dark.empty() && !off.view().same_size(on->view()))) {
    return bad_input((folder / pose.laser).string(), "this picture is not as large as that of the board",
                     "take all pictures with the same region of the same camera");
  }
  return stripe_on_board(set, on->view(), off.view());
}

}  // namespace

std::vector<Eigen::Vector2d> stripe_on_board(const CalibrationSet& set, const GrayView& on,
                                             const GrayView& off) {
  StripeOptions options;
  options.sigma_px = set.stripe_sigma_px;
  options.axis = set.stripe_per_row ? StripeAxis::kPerRow : StripeAxis::kPerColumn;
  options.least_peak = 8;  // black print gives little light back
  StripeProfile profile;
  StripeExtractor(options).extract(on, off, profile);
  return stripe_points(profile, options.axis);
}

Result<CalibrationPictures> look_at_pictures(const fs::path& folder, const CalibrationSet& set,
                                             const JobContext& job) {
  const Result<BoardSpec> board = parse_board(set.board);
  if (!board) {
    return std::unexpected(board.error());
  }
  if (Status fine = StripeOptions{.sigma_px = set.stripe_sigma_px}.check(); !fine) {
    return std::unexpected(fine.error());
  }
  CalibrationPictures out;
  out.board = *board;
  const std::size_t all = set.poses.size() + set.stops.size();
  for (std::size_t i = 0; i < all; ++i) {
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "calibration cancelled", folder.string());
    }
    job.progress("board", static_cast<double>(i) / static_cast<double>(all));
    const bool lies = i >= set.poses.size();
    const std::string& file = lies ? set.stops[i - set.poses.size()].board : set.poses[i].board;
    const Result<GrayImage> picture = read_gray(folder / file);
    if (!picture) {
      return std::unexpected(picture.error());
    }
    Result<BoardView> found = find_board(picture->view(), *board, file);
    if (!found) {
      out.left_out.push_back(file + ": " + found.error().what);
      continue;
    }
    CalibrationView view;
    view.board = std::move(*found);
    if (lies) {
      const CalibrationSet::Stop& stop = set.stops[i - set.poses.size()];
      view.fixed = stop.fixed;
      view.stage_position = stop.position;
    } else if (!set.poses[i].laser.empty()) {
      view.laser_picture = set.poses[i].laser;
      view.mirror_position = set.poses[i].mirror_rad;
      Result<std::vector<Eigen::Vector2d>> stripe = stripe_in(folder, set, set.poses[i], view.board);
      if (!stripe) {
        return std::unexpected(stripe.error());
      }
      view.stripe_px = std::move(*stripe);
    }
    out.views.push_back(std::move(view));
  }
  job.progress("board", 1);
  return out;
}

std::string numbered_picture(const char* stem, std::size_t number, const char* rest) {
  char text[64];
  std::snprintf(text, sizeof text, "%s_%02zu%s.png", stem, number, rest);
  return text;
}

std::size_t free_picture_number(const fs::path& folder, const char* stem, std::size_t from) {
  const auto is_there = [&](const char* rest) {
    std::error_code ignored;
    return fs::exists(folder / numbered_picture(stem, from, rest), ignored);
  };
  while (is_there("") || is_there("_laser") || is_there("_dark")) {
    ++from;
  }
  return from;
}

Result<CalibrationSet> set_of_folder(const fs::path& folder, const std::string& board) {
  CalibrationSet set;
  set.board = board;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    std::string ending = entry.path().extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c); });
    if (entry.is_regular_file(error) &&
        (ending == ".png" || ending == ".jpg" || ending == ".jpeg" || ending == ".pgm")) {
      set.poses.push_back({entry.path().filename().string(), {}, {}, 0});
    }
  }
  if (error) {
    return fail(ErrorKind::kUsage, "the folder cannot be read: " + error.message(), folder.string());
  }
  if (set.poses.empty()) {
    return fail(ErrorKind::kUsage, "there are no pictures in it", folder.string(),
                "give a folder with a calibration.toml, or with pictures of the board and --board");
  }
  std::sort(set.poses.begin(), set.poses.end(),
            [](const auto& a, const auto& b) { return a.board < b.board; });
  return set;
}

}  // namespace dubsar
