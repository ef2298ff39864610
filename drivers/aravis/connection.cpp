// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// From opening a camera to letting go of it: whether it is there, whom it obeys, and what goes when it goes.
#include <algorithm>
#include <thread>
#include <utility>

#include "drivers/aravis/camera.h"
#include "drivers/aravis/glib.h"

namespace dubsar::aravis {

namespace {

using namespace std::chrono_literals;

constexpr auto kControlPatience = 1500ms;
constexpr auto kControlRetry = 50ms;

}  // namespace

Result<std::unique_ptr<Camera>> Camera::open(const std::string& id, const CameraOptions& options) {
  std::unique_ptr<Camera> out(new Camera());
  out->id_ = id;
  out->options_ = options;
  if (const Status connected = out->connect(); !connected) {
    return std::unexpected(connected.error());
  }
  return out;
}

Status Camera::connect() {
  GErrorHolder error;
  camera_ = arv_camera_new(id_.c_str(), error.fill());
  if (camera_ == nullptr || error) {
    g_clear_object(&camera_);
    return std::unexpected(error.told("the camera cannot be opened", id_));
  }
  device_ = arv_camera_get_device(camera_);
  const auto told = [&](auto read) { return text_read(error, [&](GError** e) { return read(camera_, e); }); };
  const std::string serial = told(arv_camera_get_device_serial_number);
  const std::string model = told(arv_camera_get_vendor_name) + " " + told(arv_camera_get_model_name);
  if (!model_.empty() && (model != model_ || serial != serial_)) {
    g_clear_object(&camera_);
    return fail(ErrorKind::kDevice, "another camera is there now: " + model + " " + serial, id_,
                "plug in again: " + model_ + " " + serial_);
  }
  model_ = model;
  serial_ = serial;
  control_lost_ = std::make_shared<std::atomic<bool>>(false);
  g_signal_connect_data(
      device_, "control-lost", G_CALLBACK(+[](ArvDevice*, gpointer flag) {
        **static_cast<std::shared_ptr<std::atomic<bool>>*>(flag) = true;
      }),
      new std::shared_ptr<std::atomic<bool>>(control_lost_),
      +[](gpointer flag, GClosure*) { delete static_cast<std::shared_ptr<std::atomic<bool>>*>(flag); },
      static_cast<GConnectFlags>(0));
  presence_.reset();
  if (!take_control()) {
    lose();
    return fail(ErrorKind::kDevice, "the camera is in use by another program", id_,
                "close what shows its picture, then try again");
  }
  if (arv_camera_is_gv_device(camera_)) {
    GSocketAddress* address = arv_gv_device_get_device_address(ARV_GV_DEVICE(device_));
    GInetAddress* inet = g_inet_socket_address_get_address(G_INET_SOCKET_ADDRESS(address));
    if (g_inet_address_get_native_size(inet) == sizeof(std::uint32_t)) {
      std::uint32_t number = 0;
      std::copy_n(g_inet_address_to_bytes(inet), sizeof number, reinterpret_cast<std::uint8_t*>(&number));
      presence_ = std::make_unique<Presence>(number);
    }
  }
  Status configured = configure();
  if (configured && !set_here_.empty()) {
    // In the order of features(): what allows another setting stands before it.
    for (const Feature& feature : features()) {
      if (const auto kept = set_here_.find(feature.key); configured && kept != set_here_.end()) {
        configured = set(feature, dubsar_value{kept->second});
      }
    }
  }
  if (!configured) {
    lose();
  }
  return configured;
}

bool Camera::has_control() const {
  return !arv_camera_is_gv_device(camera_) || arv_gv_device_is_controller(ARV_GV_DEVICE(device_)) != 0;
}

bool Camera::has_let_go() {
  // GigE Vision 1.2, bootstrap registers: the control channel's privilege, exclusive or control.
  constexpr std::uint64_t kPrivilege = 0xa00;
  constexpr std::uint32_t kHeld = 3;
  GErrorHolder error;
  guint32 held = kHeld;
  arv_device_read_register(device_, kPrivilege, &held, error.fill());
  return !error && (held & kHeld) == 0;
}

bool Camera::is_doubtful() {
  if (!presence_ || device_ == nullptr) {
    return false;
  }
  if (!presence_->is_doubtful() && !*control_lost_ && has_let_go()) {
    *control_lost_ = true;
  }
  return presence_->is_doubtful() || *control_lost_;
}

bool Camera::take_control() {
  // Aravis takes it when it opens a camera, and does not say when that fails: as it does while the connection
  // before this one still lets go.
  const Clock::time_point enough = Clock::now() + kControlPatience;
  while (!has_control() && Clock::now() < enough) {
    std::this_thread::sleep_for(kControlRetry);
    arv_gv_device_take_control(ARV_GV_DEVICE(device_), nullptr);
  }
  return has_control();
}

std::unexpected<Error> Camera::gone() const {
  return fail(ErrorKind::kDevice, "the camera was unplugged or has stopped answering", id_,
              "plug it in again, then go on");
}

Camera::Connection Camera::let_go() {
  const std::lock_guard lock(mutex_);
  if (stream_ != nullptr) {
    ended_ = gone();
  }
  add_statistics(counts_);
  stale_.merge(lent_);
  lent_.clear();
  device_ = nullptr;
  return {std::exchange(stream_, nullptr), std::exchange(chunks_, nullptr), std::exchange(camera_, nullptr)};
}

void Camera::release(const Connection& old) {
  for (void* object :
       {static_cast<void*>(old.stream), static_cast<void*>(old.chunks), static_cast<void*>(old.camera)}) {
    if (object != nullptr) {
      g_object_unref(object);
    }
  }
}

void Camera::lose() {
  // Aravis waits for the answers of a camera that is gone for seconds, which nobody else has to.
  std::thread([old = let_go()] { release(old); }).detach();
}

}  // namespace dubsar::aravis
