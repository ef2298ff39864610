// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "tests/support/gige_scanner.h"

#include <dlfcn.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>

#include "build_paths.h"
#include "core/number_text.h"
#include "formats/calibration_json.h"
#include "sim/frame_rig.h"
#include "sim/frame_target.h"
#include "tests/drivers/peers/scanner_frames.h"
#include "tests/support/grid_truth.h"
#include "tests/support/own_network.h"

namespace dubsar::test {

namespace {

constexpr const char* kSerial = "SN8";
constexpr const char* kPeer = "DUBSAR_TEST_PEER";
constexpr const char* kLibrary = "libumockdev-preload.so.0";

}  // namespace

GigeScannerPlan small_gige_scanner(const sim::Scene& scene) {
  sim::FrameRigOptions size;
  size.width = 256;
  size.height = 200;
  size.field_mm = 6.25;
  GigeScannerPlan plan;
  plan.truth = sim::frame_rig(size);
  plan.scene = &scene;
  plan.tablet_from_scanner.translation_mm.z() = top_mm(scene.tablet->mesh) - 0.5;
  return plan;
}

GigeScanner::GigeScanner(const GigeScannerPlan& plan, PeerProcess& stage) {
  const double end = plan.start + plan.step * (plan.rows - 1);
  const double middle = 0.5 * (plan.start + end);
  RigCalibration truth = plan.truth;
  truth.camera_serial = kSerial;
  truth.made_at = GigeScanner::kMadeAt;
  truth.temperature_c = GigeScanner::kTemperatureC;
  truth.note = GigeScanner::kNote;
  tablet_from_grid_ = plan.tablet_from_scanner;
  tablet_from_grid_.translation_mm -=
      tablet_from_grid_.rotation * (truth.scanner_from_camera().rotation * truth.motion.direction) * middle;
  for (int k = -2; k < plan.rows / plan.frames_apart + 2; ++k) {
    positions_.push_back(plan.start + plan.step * plan.frames_apart * (k + plan.jitter * std::sin(2.4 * k)));
  }
  const sim::FrameRenderer renderer(truth, plan.optics);
  const auto render = [&](double position, bool laser, std::size_t number) {
    const sim::SceneTarget target(*plan.scene, tablet_from_grid_ * truth.scanner_from_camera() *
                                                   truth.motion.zero_from_camera(position));
    return renderer.render(target, laser, position, number).pixels;
  };
  std::vector<std::vector<std::uint8_t>> frames(positions_.size());
  for (std::size_t k = 0; k < positions_.size(); ++k) {
    frames[k] = render(positions_[k], true, k + 1);
  }
  const std::string path = folder_.path().string();
  std::ofstream(path + "/calibration.json") << calibration_to_json(truth);
  std::string region;
  if (plan.region) {
    region = "region_px = [" + std::to_string(plan.region->x) + ", " + std::to_string(plan.region->y) + ", " +
             std::to_string(plan.region->width) + ", " + std::to_string(plan.region->height) + "]\n";
  }
  std::ofstream(rig_file()) << "name = 'emulated'\ncamera = 'aravis:Dubsar-Scanner-" << kSerial
                            << "?format=Mono8&packet=8000'\nstage = 'usb_stage:2341:0043'\n"
                            << "calibration = 'calibration.json'\ncamera_settings = [['frame_rate_hz', '"
                            << number_text(plan.rate_hz) << "']]\n"
                            << region << "[scan]\nfrom_mm = " << number_text(plan.start)
                            << "\nto_mm = " << number_text(end) << "\nstep_mm = " << number_text(plan.step)
                            << "\ncontinuous = true\n[stripe]\nmethod = '" << plan.method << "'\n";
  if (!ScannerFrames::write(path + "/frames", static_cast<std::uint32_t>(truth.camera.width),
                            static_cast<std::uint32_t>(truth.camera.height), positions_, frames,
                            render(middle, false, 0))) {
    refusal_ = "the frames cannot be written";
    return;
  }
  if (stage.tell("firmware grbl") != "ok" || stage.tell("publish " + path + "/law") != "ok") {
    refusal_ = "the stage does not tell where it is";
    return;
  }
  camera_words_ = {DUBSAR_BINARY_DIR "/bin/scanner_peer", kSerial, path + "/frames", path + "/law",
                   number_text(plan.loss)};
  plug_camera();
}

void GigeScanner::unplug_camera() {
  ::kill(camera_->pid(), SIGKILL);
  camera_.reset();
}

void GigeScanner::plug_camera() {
  camera_.emplace(camera_words_);
  refusal_ = camera_->refusal();
}

PeerProcess* enter_emulated_machine(char** words, std::string& why) {
  if (const char* handed_over = std::getenv(kPeer); handed_over != nullptr) {
    static PeerProcess one(PeerProcess::HandedOver{handed_over});
    return &one;
  }
  if (!enter_own_network()) {
    why = "this kernel gives nobody a network of his own";
    return nullptr;
  }
  PeerProcess one(std::vector<std::string>{DUBSAR_BINARY_DIR "/bin/usb_peer"});
  if (!one.refusal().empty() || ::dlopen(kLibrary, RTLD_LAZY) == nullptr) {
    why = "umockdev's library cannot be preloaded here";
    return nullptr;
  }
  // A sanitizer's library must come first of all.
  const std::string preload = std::string(DUBSAR_SANITIZER_LIBRARY) + kLibrary;
  ::setenv("LD_PRELOAD", preload.c_str(), 1);
  ::setenv("UMOCKDEV_DIR", one.greeting().c_str(), 1);
  ::setenv(kPeer, one.hand_over().c_str(), 1);
  ::execv("/proc/self/exe", words);
  why = "the program cannot become itself again";
  return nullptr;
}

}  // namespace dubsar::test
