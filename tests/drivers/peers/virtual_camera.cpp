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

template <std::size_t N>
void put(unsigned char (&to)[N], const std::string& text) {
  std::memcpy(to, text.c_str(), std::min(text.size() + 1, N));
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

int VirtualCamera::set_format(v4l2_format& format, bool keep) {
  if (format.type != V4L2_BUF_TYPE_VIDEO_CAPTURE) {
    return -EINVAL;
  }
  v4l2_pix_format& pix = format.fmt.pix;
  const auto fits = [&](const Mode& mode) {
    return mode.fourcc == pix.pixelformat && mode.width == pix.width && mode.height == pix.height;
  };
  auto mode = std::ranges::find_if(modes_, fits);
  if (mode == modes_.end()) {
    mode = std::ranges::find(modes_, pix.pixelformat, &Mode::fourcc);
  }
  const Mode& got = mode == modes_.end() ? modes_.front() : *mode;
  if (keep) {
    now_ = got;
  }
  pix = {};
  pix.width = got.width;
  pix.height = got.height;
  pix.pixelformat = got.fourcc;
  pix.field = V4L2_FIELD_NONE;
  pix.bytesperline = picture_line_bytes(got.fourcc, got.width);
  pix.sizeimage = pix.bytesperline * got.height;
  pix.colorspace = V4L2_COLORSPACE_SRGB;
  return 0;
}

int VirtualCamera::settings(std::uint32_t request, void* argument) {
  struct Known {
    std::uint32_t id;
    const char* name;
    int type, minimum, maximum, fallback;
    int* value;
  };
  const Known all[] = {{V4L2_CID_GAIN, "Gain", V4L2_CTRL_TYPE_INTEGER, 0, 100, 10, &gain_},
                       {V4L2_CID_EXPOSURE_AUTO, "Auto Exposure", V4L2_CTRL_TYPE_MENU, 0, 3, 3, &automatic_},
                       {V4L2_CID_EXPOSURE_ABSOLUTE, "Exposure Time, Absolute", V4L2_CTRL_TYPE_INTEGER, 1,
                        5000, 50, &exposure_}};
  const auto find = [&](std::uint32_t id) {
    const bool next = (id & V4L2_CTRL_FLAG_NEXT_CTRL) != 0;
    id &= V4L2_CTRL_ID_MASK;
    return std::ranges::find_if(all, [&](const Known& one) { return next ? one.id > id : one.id == id; });
  };
  if (request == VIDIOC_QUERY_EXT_CTRL) {
    auto& query = *static_cast<v4l2_query_ext_ctrl*>(argument);
    const auto* one = find(query.id);
    if (one == std::end(all)) {
      return -EINVAL;
    }
    query = {};
    query.id = one->id;
    query.type = static_cast<std::uint32_t>(one->type);
    std::strcpy(query.name, one->name);
    query.minimum = one->minimum;
    query.maximum = one->maximum;
    query.step = 1;
    query.default_value = one->fallback;
    return 0;
  }
  if (request == VIDIOC_QUERYMENU) {
    auto& menu = *static_cast<v4l2_querymenu*>(argument);
    if (menu.id != V4L2_CID_EXPOSURE_AUTO || (menu.index != 1 && menu.index != 3)) {
      return -EINVAL;
    }
    // The struct is packed: no reference to its field.
    const char* name = menu.index == 1 ? "Manual Mode" : "Aperture Priority Mode";
    std::memcpy(&menu.name, name, std::strlen(name) + 1);
    return 0;
  }
  auto& control = *static_cast<v4l2_control*>(argument);
  const auto* one = find(control.id & V4L2_CTRL_ID_MASK);
  if (one == std::end(all)) {
    return -EINVAL;
  }
  if (request == VIDIOC_G_CTRL) {
    control.value = *one->value;
    return 0;
  }
  if (control.value < one->minimum || control.value > one->maximum ||
      (one->value == &exposure_ && automatic_ != V4L2_EXPOSURE_MANUAL)) {
    return -ERANGE;
  }
  *one->value = control.value;
  return 0;
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

int VirtualCamera::control(const void* who, std::uint32_t request, void* argument) {
  const std::lock_guard lock(mutex_);
  if (gone_) {
    return -ENODEV;
  }
  switch (request) {
    case VIDIOC_QUERYCAP: {
      auto& can = *static_cast<v4l2_capability*>(argument);
      can = {};
      put(can.driver, "virtual");
      put(can.card, card_);
      put(can.bus_info, "usb-peer-1");
      can.device_caps = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
      can.capabilities = can.device_caps | V4L2_CAP_DEVICE_CAPS;
      return 0;
    }
    case VIDIOC_ENUM_FMT: {
      auto& format = *static_cast<v4l2_fmtdesc*>(argument);
      std::vector<std::uint32_t> formats;
      for (const Mode& mode : modes_) {
        if (std::ranges::find(formats, mode.fourcc) == formats.end()) {
          formats.push_back(mode.fourcc);
        }
      }
      if (format.index >= formats.size()) {
        return -EINVAL;
      }
      format.pixelformat = formats[format.index];
      return 0;
    }
    case VIDIOC_ENUM_FRAMESIZES: {
      auto& size = *static_cast<v4l2_frmsizeenum*>(argument);
      std::uint32_t at = size.index;
      for (const Mode& mode : modes_) {
        if (mode.fourcc == size.pixel_format && at-- == 0) {
          size.type = V4L2_FRMSIZE_TYPE_DISCRETE;
          size.discrete = {mode.width, mode.height};
          return 0;
        }
      }
      return -EINVAL;
    }
    case VIDIOC_ENUM_FRAMEINTERVALS: {
      auto& interval = *static_cast<v4l2_frmivalenum*>(argument);
      for (const Mode& mode : modes_) {
        if (interval.index == 0 && mode.fourcc == interval.pixel_format && mode.width == interval.width &&
            mode.height == interval.height) {
          interval.type = V4L2_FRMIVAL_TYPE_DISCRETE;
          interval.discrete = {1, mode.rate_hz};
          return 0;
        }
      }
      return -EINVAL;
    }
    case VIDIOC_G_FMT: {
      auto& format = *static_cast<v4l2_format*>(argument);
      format.fmt.pix.width = now_.width;
      format.fmt.pix.height = now_.height;
      format.fmt.pix.pixelformat = now_.fourcc;
      return set_format(format, false);
    }
    case VIDIOC_TRY_FMT:
      return set_format(*static_cast<v4l2_format*>(argument), false);
    case VIDIOC_S_FMT:
      return occupied_ || (owner_ != nullptr && owner_ != who)
                 ? -EBUSY
                 : set_format(*static_cast<v4l2_format*>(argument), true);
    case VIDIOC_G_PARM:
    case VIDIOC_S_PARM: {
      v4l2_captureparm& capture = static_cast<v4l2_streamparm*>(argument)->parm.capture;
      if (request == VIDIOC_S_PARM && capture.timeperframe.numerator > 0) {
        now_.rate_hz = std::max(1U, (capture.timeperframe.denominator + capture.timeperframe.numerator / 2) /
                                        capture.timeperframe.numerator);
      }
      capture = {};
      capture.capability = V4L2_CAP_TIMEPERFRAME;
      capture.timeperframe = {1, now_.rate_hz};
      return 0;
    }
    case VIDIOC_QUERY_EXT_CTRL:
    case VIDIOC_QUERYMENU:
    case VIDIOC_G_CTRL:
    case VIDIOC_S_CTRL:
      return settings(request, argument);
    case VIDIOC_REQBUFS:
    case VIDIOC_QUERYBUF:
    case VIDIOC_QBUF:
    case VIDIOC_DQBUF:
    case VIDIOC_STREAMON:
    case VIDIOC_STREAMOFF:
      return buffers(who, request, argument);
    default:
      return -ENOTTY;
  }
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
  paint_picture(picture_, now_.fourcc, now_.width, now_.height, sequence);
  const bool compressed = now_.fourcc == V4L2_PIX_FMT_MJPEG;
  frame_ = compressed ? packed_picture(picture_, now_.width, now_.height) : picture_;
  v4l2_buffer buffer{};
  buffer.index = index;
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF;
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
  } else if (what == "pause" || what == "resume") {
    paused_ = what == "pause";
  } else if (what == "deny" || what == "occupy" || what == "allow") {
    denied_ = what == "deny";
    occupied_ = what == "occupy";
  } else if (what == "counts") {
    return std::to_string(made_) + " " + std::to_string(starved_) + " " + std::to_string(held_up_);
  } else if (what == "rename") {
    words >> card_;
  } else if (words >> count && what == "lose") {
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
