// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/v4l2/stream.h"

#include <linux/videodev2.h>
#include <poll.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <string>
#include <thread>

#include "drivers/v4l2/mjpeg.h"

namespace dubsar::v4l2 {

namespace {

constexpr std::uint32_t kType = V4L2_BUF_TYPE_VIDEO_CAPTURE;
/// How long one wait lasts before the camera is asked whether it is still there.
constexpr std::chrono::milliseconds kLookEvery(250);
/// After a wait that ended without a frame though something was signalled.
constexpr std::chrono::milliseconds kPause(2);

v4l2_buffer buffer_at(std::uint32_t index) {
  v4l2_buffer out{};
  out.type = kType;
  out.memory = V4L2_MEMORY_MMAP;
  out.index = index;
  return out;
}

std::int64_t now_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1000000000 + now.tv_nsec;
}

Error gone(const Node& node) {
  return {ErrorKind::kDevice, "the camera was unplugged or has stopped answering", node.path(),
          "plug it in again, then go on"};
}

}  // namespace

Result<std::shared_ptr<Stream>> Stream::start(const Node& node, const Mode& mode, bool limited,
                                              std::uint32_t stride, std::uint32_t pool) {
  auto stream = std::shared_ptr<Stream>(new Stream(node));
  stream->mode_ = mode;
  stream->use_ = use_of(mode.fourcc);
  stream->limited_ = limited;
  stream->stride_ = stride;
  if (const Status taken = stream->take_buffers(pool); !taken) {
    return std::unexpected(taken.error());
  }
  int type = kType;
  if (node.control(VIDIOC_STREAMON, &type) != 0) {
    return std::unexpected(error_of(errno, "the stream does not start", node.path()));
  }
  stream->running_ = true;
  return stream;
}

Status Stream::take_buffers(std::uint32_t pool) {
  v4l2_requestbuffers request{};
  request.count = pool;
  request.type = kType;
  request.memory = V4L2_MEMORY_MMAP;
  if (node_->control(VIDIOC_REQBUFS, &request) != 0) {
    return std::unexpected(error_of(errno, "the camera has no buffers to map", node_->path()));
  }
  if (request.count < 2) {
    return fail(ErrorKind::kDevice, "the camera gives one buffer or none", node_->path(),
                "ask for a smaller frame with ?size=");
  }
  for (std::uint32_t k = 0; k < request.count; ++k) {
    v4l2_buffer buffer = buffer_at(k);
    if (node_->control(VIDIOC_QUERYBUF, &buffer) != 0) {
      return std::unexpected(error_of(errno, "the camera refuses a buffer", node_->path()));
    }
    void* at = node_->map(buffer.length, buffer.m.offset);
    if (at == MAP_FAILED) {
      return std::unexpected(error_of(errno, "the camera's buffers cannot be mapped", node_->path()));
    }
    mapped_.push_back({at, buffer.length});
  }
  const bool compressed = use_.handling == Handling::kCompressed;
  const bool copied = compressed || limited_ || use_.handling == Handling::kPackedLuma ||
                      use_.handling == Handling::kConverted;
  const std::size_t pixels = std::size_t{mode_.width} * mode_.height;
  const std::size_t needed = compressed                              ? 1
                             : use_.handling == Handling::kConverted ? pixels
                                                                     : std::size_t{stride_} * mode_.height;
  if (std::ranges::any_of(mapped_, [&](const Mapped& one) { return one.length < needed; })) {
    return fail(ErrorKind::kDevice, "the camera's buffers are smaller than its frames", node_->path(),
                "ask for another ?format= or ?size=");
  }
  if (copied) {
    copies_.assign(mapped_.size(), std::vector<std::uint8_t>(pixels));
  }
  lent_.assign(mapped_.size(), false);
  for (std::uint32_t k = 0; k < mapped_.size(); ++k) {
    if (!queue(k)) {
      return std::unexpected(error_of(errno, "the camera refuses a buffer", node_->path()));
    }
  }
  return {};
}

bool Stream::queue(std::uint32_t buffer) const {
  v4l2_buffer queued = buffer_at(buffer);
  return node_->control(VIDIOC_QBUF, &queued) == 0;
}

/// A place of our own pool, once one is free.
std::optional<std::uint32_t> Stream::reserve(Clock::time_point until) {
  std::unique_lock lock(mutex_);
  const auto free = [&] { return std::ranges::find(lent_, false) != lent_.end(); };
  if (!returned_.wait_until(lock, until, free)) {
    return std::nullopt;
  }
  const auto place = std::ranges::find(lent_, false) - lent_.begin();
  return static_cast<std::uint32_t>(place);
}

/// Brings the luma of a filled buffer, whose lines are so many bytes apart, into our own pool. False when it
/// is no picture.
bool Stream::copy_luma(const std::uint8_t* from, std::size_t line, std::uint32_t used,
                       std::vector<std::uint8_t>& to) const {
  if (use_.handling == Handling::kCompressed) {
    std::string why;
    return decode_luma({from, used}, mode_.width, mode_.height, to, why);
  }
  const std::size_t apart = use_.bytes_per_pixel;
  std::uint8_t* at = to.data();
  for (std::uint32_t row = 0; row < mode_.height; ++row) {
    const std::uint8_t* const in = from + row * line + use_.luma_at;
    for (std::uint32_t col = 0; col < mode_.width; ++col) {
      *at++ = in[apart * col];
    }
  }
  if (limited_) {
    expand_range(to);
  }
  return true;
}

/// Where the pixels of a filled buffer are: in it, or in a copy at `place`. Nothing when they are no picture.
std::optional<dubsar_frame> Stream::describe(const void* buffer, std::uint32_t used, std::uint32_t place) {
  dubsar_frame frame{};
  frame.struct_size = sizeof frame;
  frame.lease = place;
  frame.width = mode_.width;
  frame.height = mode_.height;
  frame.pixel_format = use_.pixel_format;
  const auto* from = static_cast<const std::uint8_t*>(buffer);
  // What libv4l2 converted has no gaps between its lines.
  const std::uint64_t line = use_.handling == Handling::kConverted ? mode_.width : stride_;
  std::uint64_t whole = line * (mode_.height - 1) + std::uint64_t{mode_.width} * use_.bytes_per_pixel;
  if (copies_.empty()) {
    frame.pixels = from;
    frame.stride_bytes = stride_;
  } else {
    if (!copy_luma(from, line, used, copies_[place])) {
      return std::nullopt;
    }
    frame.pixels = copies_[place].data();
    frame.stride_bytes = mode_.width;
    whole = use_.handling == Handling::kCompressed ? used : whole;
  }
  if (used < whole) {
    frame.flags |= DUBSAR_FRAME_INCOMPLETE;
  }
  frame.size_bytes = std::uint64_t{frame.stride_bytes} * frame.height;
  return frame;
}

Result<std::optional<dubsar_frame>> Stream::next(Clock::time_point until) {
  if (!running_) {
    return fail(ErrorKind::kUsage, "no stream runs", node_->path(), "start the frames first");
  }
  for (;;) {
    std::uint32_t place = 0;
    if (!copies_.empty()) {
      const std::optional<std::uint32_t> reserved = reserve(until);
      if (!reserved) {
        return std::nullopt;
      }
      place = *reserved;
    }
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
    const auto wait = std::clamp(left, std::chrono::milliseconds(0), kLookEvery);
    pollfd waiting{node_->fd(), POLLIN, 0};
    const int ready = ::poll(&waiting, 1, static_cast<int>(wait.count()));
    v4l2_buffer buffer = buffer_at(0);
    if (ready <= 0 || node_->control(VIDIOC_DQBUF, &buffer) != 0) {
      const int why = ready > 0 ? errno : EAGAIN;
      const bool hung_up = ready > 0 && (waiting.revents & (POLLHUP | POLLNVAL)) != 0;
      if (means_gone(why) || hung_up || !node_->alive()) {
        return std::unexpected(gone(*node_));
      }
      if (why != EAGAIN && why != EIO && why != EINTR) {
        return std::unexpected(error_of(why, "the stream broke off", node_->path()));
      }
      if (why == EIO) {
        numbers_.went_wrong();
      }
      if (Clock::now() >= until) {
        return std::nullopt;
      }
      if (ready > 0) {  // signalled, yet nothing to fetch: all buffers are lent, say
        std::this_thread::sleep_for(std::min<Clock::duration>(kPause, until - Clock::now()));
      }
      continue;
    }
    if (buffer.index >= mapped_.size()) {
      return fail(ErrorKind::kDevice, "the camera fills a buffer that there is not", node_->path(),
                  "plug it in again; if that does not help, it or its driver is broken");
    }
    const std::int64_t now = now_ns();
    if (copies_.empty()) {
      place = buffer.index;
    }
    const Mapped& filled = mapped_[buffer.index];
    const auto used = static_cast<std::uint32_t>(std::min<std::size_t>(buffer.bytesused, filled.length));
    const std::optional<dubsar_frame> described = describe(filled.at, used, place);
    if (!copies_.empty()) {
      queue(buffer.index);
    }
    if (!described) {
      // A gap in the numbers: it counts as lost when the next whole one comes.
      if (Clock::now() >= until) {
        return std::nullopt;
      }
      continue;
    }
    dubsar_frame frame = *described;
    if ((buffer.flags & V4L2_BUF_FLAG_ERROR) != 0) {
      frame.flags |= DUBSAR_FRAME_INCOMPLETE;
    }
    const FrameNumbers::Step step = numbers_.take(buffer.sequence);
    frame.id = step.id;
    frame.timestamp_ns = now;
    const std::int64_t stamp =
        std::int64_t{buffer.timestamp.tv_sec} * 1000000000 + std::int64_t{buffer.timestamp.tv_usec} * 1000;
    if ((buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC && stamp > 0) {
      frame.timestamp_ns = stamp;
      frame.device_timestamp_ns = stamp;
    }
    // A stamp of the frame's beginning is older by the time that the frame took to come. That of its
    // exposure, which the flag means, it is not: uvcvideo always sets the flag, and stamps the first bytes
    // that arrive.
    const bool begun = (buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
    const double periods = begun ? 2 : 1;
    const double period_ns = mode_.rate_hz > 0 ? 1e9 / mode_.rate_hz : 1e9;
    if (static_cast<double>(now - frame.timestamp_ns) > periods * period_ns) {
      frame.flags |= DUBSAR_FRAME_LATE;
    }
    const std::lock_guard lock(mutex_);
    lent_[place] = true;
    ++counts_.delivered;
    counts_.lost += step.lost;
    counts_.late += (frame.flags & DUBSAR_FRAME_LATE) != 0 ? 1 : 0;
    counts_.incomplete += (frame.flags & DUBSAR_FRAME_INCOMPLETE) != 0 ? 1 : 0;
    return frame;
  }
}

void Stream::give_back(std::uint32_t buffer) {
  const std::lock_guard lock(mutex_);
  if (buffer >= lent_.size() || !lent_[buffer]) {
    return;
  }
  lent_[buffer] = false;
  if (running_ && copies_.empty()) {
    queue(buffer);
  }
  returned_.notify_one();
}

void Stream::stop() {
  const std::lock_guard lock(mutex_);
  if (stopped_) {
    return;
  }
  stopped_ = true;
  running_ = false;
  int type = kType;
  node_->control(VIDIOC_STREAMOFF, &type);
  if (!copies_.empty()) {  // nothing is lent of these
    for (const Mapped& mapped : mapped_) {
      node_->unmap(mapped.at, mapped.length);
    }
    mapped_.clear();
  }
}

Stream::~Stream() {
  // Behind stop() the node may be closed already; mappings outlive their file.
  for (const Mapped& mapped : mapped_) {
    stopped_ ? static_cast<void>(::munmap(mapped.at, mapped.length)) : node_->unmap(mapped.at, mapped.length);
  }
}

std::uint32_t Stream::lent() const {
  const std::lock_guard lock(mutex_);
  return static_cast<std::uint32_t>(std::ranges::count(lent_, true));
}

Counts Stream::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

}  // namespace dubsar::v4l2
