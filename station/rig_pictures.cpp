// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/rig_pictures.h"

#include <algorithm>
#include <cstdio>
#include <string>

#include "acquisition/board.h"
#include "formats/atomic_file.h"
#include "formats/calibration_json.h"
#include "formats/calibration_set.h"
#include "formats/gray_file.h"
#include "formats/make_folder.h"
#include "sim/board_poses.h"

namespace dubsar {

namespace {

constexpr int kTexels = 80;           // per square
constexpr double kBoardSignal = 0.4;  // ambient light when the board is to be seen
constexpr double kHalfTravelMm = 6;
constexpr double kHalfTurnRad = 0.3;
constexpr double kHalfSwingRad = 0.02;

std::string numbered(const char* stem, int number, const char* rest) {
  char text[64];
  std::snprintf(text, sizeof text, "%s_%02d%s.png", stem, number, rest);
  return text;
}

class Photographer {
 public:
  Photographer(const RigPicturesOptions& options, const RigCalibration& truth, const BoardSpec& board)
      : board_(board),
        pattern_(board_pattern(board, kTexels)),
        dim_(truth, options.optics),
        bright_(truth, [&] {
          sim::FrameOptions lit = options.optics;
          lit.ambient_signal = kBoardSignal;
          return lit;
        }()) {}

  [[nodiscard]] Status take(const std::filesystem::path& file, const RigidTransform& camera_from_board,
                            bool bright, bool laser, double mirror) {
    const sim::BoardTarget target(pattern_, board_.square_mm / kTexels, -board_.low_mm(), camera_from_board);
    return write_gray_png((bright ? bright_ : dim_).render(target, laser, mirror, ++frame_), file);
  }

 private:
  BoardSpec board_;
  GrayImage pattern_;
  sim::FrameRenderer dim_;
  sim::FrameRenderer bright_;
  std::uint64_t frame_ = 0;
};

}  // namespace

Status write_rig_pictures(const RigPicturesOptions& options, const std::filesystem::path& folder,
                          const JobContext& job) {
  const Result<BoardSpec> board = parse_board(options.board);
  if (!board) {
    return std::unexpected(board.error());
  }
  if (Status made = make_folder(folder); !made) {
    return made;
  }
  const RigCalibration truth = sim::frame_rig(options.rig);
  sim::FrameOptions optics = options.optics;
  optics.seed = options.seed;
  RigPicturesOptions seeded = options;
  seeded.optics = optics;
  Photographer photographer(seeded, truth, *board);
  CalibrationSet set;
  set.board = options.board;
  set.motion = options.rig.motion;
  set.camera_serial = truth.camera_serial;
  set.depth_range_mm = truth.depth_range_mm;
  set.note = "rendered, with a truth.json beside it";
  set.stripe_sigma_px = std::clamp(1.2 * optics.laser_sigma_mm / truth.field_per_px_mm(), 0.8, 6.0);
  const bool mirror = options.rig.motion == MotionKind::kGalvanometer;
  const int all = options.poses + (mirror ? 0 : options.stops);
  int done = 0;
  const auto going = [&]() -> Status {
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "stopped before all pictures were rendered", folder.string());
    }
    job.progress("pictures", static_cast<double>(done++) / all);
    return {};
  };
  for (const RigidTransform& pose :
       sim::board_poses(truth, board->low_mm(), board->high_mm(), options.poses, options.seed)) {
    const int i = static_cast<int>(set.poses.size());
    const double position = mirror ? kHalfSwingRad * (i % 3 - 1) : 0;
    set.poses.push_back(
        {numbered("pose", i, ""), numbered("pose", i, "_laser"), numbered("pose", i, "_dark"), position});
    const CalibrationSet::Pose& names = set.poses.back();
    Status status = going();
    status = status ? photographer.take(folder / names.board, pose, true, false, position) : status;
    status = status ? photographer.take(folder / names.laser, pose, false, true, position) : status;
    status = status ? photographer.take(folder / names.dark, pose, false, false, position) : status;
    if (!status) {
      return status;
    }
  }
  std::vector<double> positions;
  positions.reserve(static_cast<std::size_t>(std::max(0, options.stops)));
  const double half = options.rig.motion == MotionKind::kTurntable ? kHalfTurnRad : kHalfTravelMm;
  for (int i = 0; i < (mirror ? 0 : options.stops); ++i) {
    positions.push_back(half * (2.0 * i / std::max(1, options.stops - 1) - 1));
  }
  for (const RigidTransform& pose : sim::carried_board(truth, board->low_mm(), board->high_mm(), positions)) {
    const int i = static_cast<int>(set.stops.size());
    set.stops.push_back({numbered("stage", i, ""), "board", positions[static_cast<std::size_t>(i)]});
    Status status = going();
    status = status ? photographer.take(folder / set.stops.back().board, pose, true, false, 0) : status;
    if (!status) {
      return status;
    }
  }
  if (Status status = write_file_atomically(folder / "truth.json", calibration_to_json(truth)); !status) {
    return status;
  }
  return write_file_atomically(folder / "calibration.toml", calibration_set_to_toml(set));
}

}  // namespace dubsar
