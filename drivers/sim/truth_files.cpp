// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/sim/truth_files.h"

#include "formats/make_folder.h"
#include "formats/mesh_io.h"
#include "formats/pins_json.h"
#include "formats/poses_json.h"
#include "formats/truth_json.h"

namespace dubsar::sim_driver {

TruthFiles::TruthFiles(std::filesystem::path folder, const sim::SimStation& station)
    : folder_(std::move(folder)) {
  true_pins_.tip_diameter_mm = station.empty_grid().pin_tip_diameter_mm;
  clicked_pins_.tip_diameter_mm = true_pins_.tip_diameter_mm;
}

Status TruthFiles::begin(const sim::SimStation& station) const {
  if (Status made = make_folder(folder_); !made) {
    return made;
  }
  if (Status written = write_mesh(folder_ / "tablet.ply", station.tablet().mesh); !written) {
    return written;
  }
  TabletTruth truth;
  truth.mesh = "tablet.ply";
  truth.wedges = station.tablet().wedges;
  return write_truth(folder_ / "truth.json", truth);
}

Status TruthFiles::add_scan(int id, const std::string& name, const sim::SimStation& station) {
  ScanPose pose;
  pose.id = id;
  pose.file = name;
  pose.model_from_scanner = station.true_tablet_from_scanner();
  pose.status = PoseStatus::kRegistered;
  poses_.push_back(std::move(pose));
  if (Status written = write_poses(folder_ / "truth_poses.json", poses_); !written) {
    return written;
  }
  if (true_pins_.tip_diameter_mm == 0) {
    return {};
  }
  true_pins_.tips[id] = station.true_tips();
  clicked_pins_.tips[id] = station.clicked_tips();
  if (Status written = write_pins(folder_ / "truth_pins.json", true_pins_); !written) {
    return written;
  }
  return write_pins(folder_ / "pins.json", clicked_pins_);
}

}  // namespace dubsar::sim_driver
