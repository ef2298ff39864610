// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/rig_calibration.h"
#include "formats/rig_toml.h"
#include "sim/frame_renderer.h"
#include "sim/scene.h"
#include "tests/support/peer_process.h"
#include "tests/support/temporary_folder.h"

namespace dubsar::test {

/// A whole scanner of emulated parts: a camera that serves rendered frames as GigE Vision packets on the
/// loopback, and a stage behind an emulated USB port (GRBL). What the camera sees follows where the stage
/// stands at the time of the exposure.
struct GigeScannerPlan {
  RigCalibration truth;
  const sim::Scene* scene = nullptr;
  /// Where the tablet lies when the stage stands in the middle of the scan, scanner frame.
  RigidTransform tablet_from_scanner;
  sim::FrameOptions optics;
  double start = -60;  ///< of the stage, mm; GRBL's axis goes from -200 to 0
  double step = 0.05;  ///< mm
  int rows = 32;
  double rate_hz = 50;  ///< of the camera, as it tells
  /// From frame to frame, in steps: other than 1 of a camera that does not keep the rate that it tells.
  double frames_apart = 1;
  /// How far the frames lie from even spacing, in steps: only the clock tells where each was taken.
  double jitter = 0.2;
  double loss = 0;                           ///< share of the packets
  std::string method = "adaptive";           ///< of finding the stripe
  std::optional<PictureRegion> region = {};  ///< of the picture that the rig asks for
};

/// A camera of few pixels over the middle of the scene's tablet, for tests that are quick.
[[nodiscard]] GigeScannerPlan small_gige_scanner(const sim::Scene& scene);

class GigeScanner {
 public:
  // What its calibration says of itself.
  static constexpr const char* kMadeAt = "2026-01-01T00:00:00Z";
  static constexpr double kTemperatureC = 18.5;
  static constexpr const char* kNote = "by the window";

  /// Renders, writes rig.toml and calibration.json, and starts the camera. `stage` is a usb_peer.
  GigeScanner(const GigeScannerPlan& plan, PeerProcess& stage);
  /// Empty when it is ready.
  [[nodiscard]] const std::string& refusal() const { return refusal_; }
  [[nodiscard]] std::filesystem::path rig_file() const { return folder_.path() / "rig.toml"; }
  [[nodiscard]] PeerProcess& camera() { return *camera_; }
  /// Pulls the camera's cable, and plugs it in again. A camera that does not come back says so in refusal().
  void unplug_camera();
  void plug_camera();
  /// Of the stage, for which a frame was rendered.
  [[nodiscard]] const std::vector<double>& positions() const { return positions_; }
  /// Scanner frame of the grid, positions of the stage as they are, to the tablet's.
  [[nodiscard]] const RigidTransform& tablet_from_grid() const { return tablet_from_grid_; }

 private:
  TemporaryFolder folder_;
  RigidTransform tablet_from_grid_;
  std::vector<double> positions_;
  std::vector<std::string> camera_words_;
  std::optional<PeerProcess> camera_;
  std::string refusal_;
};

/// A usb_peer whose device this program sees, in a network of its own: at the first call the program becomes
/// itself again with umockdev's library. Call it first of all in main. nullptr where the kernel does not
/// allow it; `why` then says what.
[[nodiscard]] PeerProcess* enter_emulated_machine(char** words, std::string& why);

}  // namespace dubsar::test
