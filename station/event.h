// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "archive/render_scene.h"
#include "core/mesh.h"
#include "core/pin_set.h"
#include "core/range_grid.h"
#include "core/red_map.h"
#include "core/sample_flags.h"
#include "core/scan_pose.h"
#include "station/camera_view.h"
#include "station/device_panel.h"
#include "station/view_gain.h"

namespace dubsar {

/// One profile has arrived and its flags are as current as the stream allows. Refers to the growing grid:
/// valid during the call only.
struct ProfileArrived {
  int row = 0;
  const RangeGrid* grid = nullptr;
  const SampleFlags* flags = nullptr;
};
/// The scan is on the disk, whole: it survives whatever happens now.
struct ScanStored {
  int id = 0;
  std::string file;
  std::int64_t samples = 0;
  std::string remark{};  ///< of its device, for the operator; empty where there is none
  /// Its device may be at the next one by now: none waits for what is made of this one.
  bool scans_on = false;
};
/// A scan that the engine has dropped by itself: what was in its way.
struct SetAside {
  int id = 0;
  std::string why;
};
/// Registration has judged the scan; relaxation may have moved the others.
struct ScanPlaced {
  ScanPose pose;
  std::vector<ScanPose> all;
  std::shared_ptr<const RangeGrid> measured;  ///< as it came, pins and all
  std::shared_ptr<const RangeGrid> grid;      ///< the tablet alone
  std::shared_ptr<const SampleFlags> flags;   ///< of its samples, as the scan alone gives them
  std::vector<SetAside> set_aside;            ///< since it came: itself, or earlier ones
};
/// What the operator asked for is done and stored; the poses are those that follow from it.
struct OperatorObeyed {
  std::string what;
  std::vector<ScanPose> all;
  bool asks_again =
      false;  ///< a run that waits thinks the next step over, and then says anew what it waits for
  std::vector<int> taken_out{};  ///< by the operator in this run. Who only lacks in `all` may not be read yet
};
struct RedMapChanged {
  RedMap red_map;
  std::optional<ViewGain> gain;  ///< of the scan that changed it
};
/// The device begins with what it takes to the next scan, where no NextPlacement says so: motors may run, if
/// only to their switches, and lasers go on. Nothing has moved yet.
struct DeviceStarts {};
/// The device rests: no scan is under way, and none is taken any more, unless a DeviceStarts, a NextPlacement
/// or a WaitsForOperator follows (what is settled may be red still).
struct DeviceRests {
  std::optional<Error> error{};  ///< of the device, or of what it was asked for: what ended the scanning
};
/// The rig is about to be moved, or the operator is asked for a turn.
struct NextPlacement {
  NextView view;
};
/// A paced run goes on with ScanNow; `next` is empty where nothing has been proposed.
struct WaitsForOperator {
  std::optional<NextView> next;
  bool not_taken_up = false;  ///< the last scan is unsure or failed: a hint may settle it
};
/// The mesh of what is placed, and what is red on it. Only with EngineOptions::show_model.
struct ModelChanged {
  std::shared_ptr<const Mesh> mesh;
  std::shared_ptr<const ColouredPoints> red;
  RigidTransform tablet_from_model;
};
/// What is known of the pins, when the run begins and whenever the operator has labelled some or taken labels
/// back; nothing where none are known any more.
struct PinsKnown {
  std::shared_ptr<const PinSet> pins;
};
/// The settings of the open device, when it is opened and whenever one was changed.
struct DeviceTells {
  std::shared_ptr<const DevicePanel> panel;
};
/// What the camera sees now; nothing when it is looked through no more.
struct CameraFrame {
  std::shared_ptr<const CameraView> view;
};
/// Something that the operator should know and that stops nothing.
struct Notice {
  std::string text;
};

using Event = std::variant<ProfileArrived, ScanStored, ScanPlaced, OperatorObeyed, RedMapChanged,
                           DeviceStarts, DeviceRests, NextPlacement, WaitsForOperator, ModelChanged,
                           PinsKnown, DeviceTells, CameraFrame, Notice>;

/// Called on the engine's threads, one call at a time per stage: be quick, take snapshots, and never call
/// back into the engine.
using EventSink = std::function<void(const Event&)>;

}  // namespace dubsar
