// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "tests/drivers/peers/virtual_camera.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <sstream>
#include <thread>

#include "tests/drivers/peers/virtual_picture.h"

namespace dubsar::test {

namespace {

std::int64_t now_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1000000000 + now.tv_nsec;
}

}  // namespace

VirtualCamera::VirtualCamera(std::string card, std::vector<Mode> modes)
    : card_(std::move(card)), modes_(std::move(modes)), now_(modes_.front()), stride_(0) {
  for (const Mode& mode : modes_) {
    const std::uint64_t size = std::uint64_t{picture_line_bytes(mode.fourcc, mode.width)} * mode.height;
    stride_ = std::max(stride_, (size + 4095) / 4096 * 4096);
  }
}

int VirtualCamera::opened(const void* /*who*/) {
  const std::lock_guard lock(mutex_);
  return gone_ ? -ENXIO : denied_ ? -EACCES : 0;
}

void VirtualCamera::closed(const void* who) {
  const std::lock_guard lock(mutex_);
  if (owner_ == who) {
    owner_ = nullptr;
    streaming_ = false;
    count_ = 0;
    queued_.clear();
    done_.clear();
  }
}

bool VirtualCamera::gone() {
  const std::lock_guard lock(mutex_);
  return gone_;
}

short VirtualCamera::poll_events(const void* who) {
  const std::lock_guard lock(mutex_);
  if (gone_) {
    return POLLERR | POLLHUP;
  }
  if (owner_ != who || !streaming_ || (queued_.empty() && done_.empty())) {
    return POLLERR;
  }
  return done_.empty() ? 0 : POLLIN | POLLRDNORM;
}

int VirtualCamera::buffers(const void* who, std::uint32_t request, void* argument) {
  if (request == VIDIOC_REQBUFS) {
    auto& asked = *static_cast<v4l2_requestbuffers*>(argument);
    if (occupied_ || (owner_ != nullptr && owner_ != who)) {
      return -EBUSY;
    }
    if (asked.memory != V4L2_MEMORY_MMAP) {
      return -EINVAL;
    }
    asked.count = std::min(asked.count, kMostBuffers);
    count_ = asked.count;
    owner_ = count_ > 0 ? who : nullptr;
    queued_.clear();
    done_.clear();
    return 0;
  }
  if (request == VIDIOC_STREAMON || request == VIDIOC_STREAMOFF) {
    streaming_ = request == VIDIOC_STREAMON && owner_ == who;
    sequence_ = 0;
    due_ns_ = 0;
    if (!streaming_) {
      queued_.clear();
      done_.clear();
    }
    return request == VIDIOC_STREAMON && owner_ != who ? -EINVAL : 0;
  }
  auto& buffer = *static_cast<v4l2_buffer*>(argument);
  if (request == VIDIOC_DQBUF) {
    if (!streaming_ || owner_ != who) {
      return -EINVAL;
    }
    if (done_.empty()) {
      return kNotYet;
    }
    buffer = done_.front();
    done_.pop_front();
    return 0;
  }
  if (buffer.index >= count_ || owner_ != who) {
    return -EINVAL;
  }
  const std::uint32_t index = buffer.index;
  if (request == VIDIOC_QBUF) {
    if (std::ranges::find(queued_, index) != queued_.end()) {
      return -EINVAL;
    }
    queued_.push_back(index);
  }
  buffer = {};
  buffer.index = index;
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.length = static_cast<std::uint32_t>(stride_);
  buffer.m.offset = static_cast<std::uint32_t>(index * stride_);
  return 0;
}

bool VirtualCamera::tick(const std::function<void(std::uint64_t, const std::vector<std::uint8_t>&)>& store) {
  std::unique_lock lock(mutex_);
  const std::int64_t now = now_ns();
  if (gone_ || !streaming_ || paused_) {
    due_ns_ = 0;
    lock.unlock();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return false;
  }
  due_ns_ = due_ns_ == 0 ? now : due_ns_;
  if (now < due_ns_) {
    lock.unlock();
    std::this_thread::sleep_for(std::chrono::nanoseconds(std::min<std::int64_t>(due_ns_ - now, 1000000)));
    return false;
  }
  const std::int64_t period = 1000000000 / now_.rate_hz;
  due_ns_ += period;
  if (now > due_ns_ + period) {
    due_ns_ = now;  // this machine was away; a camera would not catch up either
    ++held_up_;
  }
  ++made_;
  for (; lose_ > 0; --lose_) {
    ++sequence_;
  }
  const std::uint32_t sequence = sequence_++;
  if (queued_.empty()) {
    ++starved_;
    return false;  // lost for want of a buffer
  }
  const std::uint32_t index = queued_.front();
  queued_.pop_front();
  paint_picture(picture_, now_.fourcc, now_.width, now_.height, sequence, 7 * crop_x_ + 3 * crop_y_);
  const bool compressed = now_.fourcc == V4L2_PIX_FMT_MJPEG;
  frame_ = compressed ? packed_picture(picture_, now_.width, now_.height) : picture_;
  v4l2_buffer buffer{};
  buffer.index = index;
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;  // as uvcvideo
  buffer.bytesused = static_cast<std::uint32_t>(frame_.size());
  buffer.sequence = sequence;
  buffer.length = static_cast<std::uint32_t>(stride_);
  buffer.m.offset = static_cast<std::uint32_t>(index * stride_);
  if (spoil_ > 0) {
    --spoil_;
    if (compressed) {  // as a bad cable does it: nobody notices but the reader
      std::fill(frame_.begin() + static_cast<std::ptrdiff_t>(frame_.size() / 3), frame_.end(), 0xff);
    } else {
      buffer.flags |= V4L2_BUF_FLAG_ERROR;
    }
  }
  if (shorten_ > 0) {
    --shorten_;
    buffer.bytesused /= 2;
  }
  lock.unlock();  // the kernel may be waiting for an answer of ours before it takes the pixels
  store(index * stride_, frame_);
  lock.lock();
  const std::int64_t stamp = now_ns();
  buffer.timestamp = {stamp / 1000000000, stamp % 1000000000 / 1000};
  if (!streaming_ || gone_) {
    return false;
  }
  done_.push_back(buffer);
  return true;
}

std::string VirtualCamera::command(const std::string& line) {
  std::istringstream words(line);
  std::string what;
  words >> what;
  int count = 0;
  const std::lock_guard lock(mutex_);
  if (what == "unplug") {
    gone_ = true;
    streaming_ = false;
    queued_.clear();
    done_.clear();
  } else if (what == "plug") {
    gone_ = false;
    owner_ = nullptr;
    count_ = 0;
    gain_ = 10;
    automatic_ = V4L2_EXPOSURE_APERTURE_PRIORITY;
    exposure_ = 50;
    focus_ = 0;
    automatic_focus_ = 1;
    automatic_gain_ = 1;
    crop_x_ = crop_y_ = 0;
    now_ = modes_.front();
    picture_.clear();
  } else if (what == "pause" || what == "resume") {
    paused_ = what == "pause";
  } else if (what == "deny" || what == "occupy" || what == "allow") {
    denied_ = what == "deny";
    occupied_ = what == "occupy";
  } else if (what == "stretch") {
    stretched_ = true;
  } else if (what == "counts") {
    return std::to_string(made_) + " " + std::to_string(starved_) + " " + std::to_string(held_up_);
  } else if (what == "rename") {
    words >> card_;
  } else if (words >> count && what == "crop") {
    crop_step_ = static_cast<std::uint32_t>(count);
  } else if (what == "lose") {
    lose_ = count;
  } else if (what == "spoil") {
    spoil_ = count;
  } else if (what == "shorten") {
    shorten_ = count;
  } else {
    return "what?";
  }
  return "ok";
}

}  // namespace dubsar::test
