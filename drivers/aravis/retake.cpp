// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A camera that let go of this program in mid-stream, taken again. Each of Aravis's questions to one that
// dies meanwhile waits for seconds, and a connection asks many: so a thread of its own asks them, and whoever
// waits for frames looks whether the camera is there at all.
#include <condition_variable>
#include <thread>
#include <utility>

#include "drivers/aravis/camera.h"

namespace dubsar::aravis {

namespace {

constexpr std::chrono::milliseconds kLookEvery{50};

/// What the two threads share; either may be the last to leave it.
struct Attempt {
  std::mutex mutex;
  std::condition_variable ended;
  std::optional<Status> done;
  std::unique_ptr<Camera> taken;  ///< whose stream runs
  bool abandoned = false;
};

}  // namespace

Status Camera::retake() {
  // As this one, without what belongs to its connection.
  std::unique_ptr<Camera> fresh(new Camera());
  fresh->id_ = id_;
  fresh->model_ = model_;
  fresh->serial_ = serial_;
  fresh->options_ = options_;
  fresh->set_here_ = set_here_;
  fresh->said_room_ = true;
  const std::uint32_t pool = counts_.pool;
  const auto attempt = std::make_shared<Attempt>();
  std::thread([attempt, pool, old = let_go(), camera = std::move(fresh)]() mutable {
    // First of all: its last word ends the stream of that address, and must not end the new one.
    release(old);
    const Status begun = camera->begin(pool);
    const std::lock_guard lock(attempt->mutex);
    attempt->done = begun;
    // What nobody waits for any more, or never ran, is let go of here, where it may take its time.
    if (begun && !attempt->abandoned) {
      attempt->taken = std::move(camera);
    }
    attempt->ended.notify_one();
  }).detach();
  std::unique_lock lock(attempt->mutex);
  while (!attempt->ended.wait_for(lock, kLookEvery, [&] { return attempt->done.has_value(); })) {
    if (presence_->gone()) {
      attempt->abandoned = true;
      return gone();
    }
  }
  if (attempt->taken) {
    adopt(*attempt->taken);
  }
  return *attempt->done;
}

void Camera::adopt(Camera& fresh) {
  const std::lock_guard lock(mutex_);
  camera_ = std::exchange(fresh.camera_, nullptr);
  device_ = std::exchange(fresh.device_, nullptr);
  presence_ = std::move(fresh.presence_);
  range_ = fresh.range_;
  pixel_format_ = fresh.pixel_format_;
  bytes_per_pixel_ = fresh.bytes_per_pixel_;
  set_here_ = std::move(fresh.set_here_);
  control_lost_ = fresh.control_lost_;
  stream_ = std::exchange(fresh.stream_, nullptr);
  ended_ = {};
  chunks_ = std::exchange(fresh.chunks_, nullptr);
  has_encoder_chunk_ = fresh.has_encoder_chunk_;
  payload_ = fresh.payload_;
  clock_ = fresh.clock_;
  counts_.pool = fresh.counts_.pool;
  ++counts_.reconnections;
  count_.go_on();
}

}  // namespace dubsar::aravis
