// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The stream of a camera, from start() to stop(); the connection under it is in connection.cpp.
#include "drivers/aravis/camera.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <utility>

#include "core/log.h"
#include "core/pool_depth.h"
#include "core/thread_priority.h"
#include "drivers/aravis/close_up.h"
#include "drivers/aravis/glib.h"
#include "drivers/aravis/packet_room.h"

namespace dubsar::aravis {

namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kMostBuffers = 256;
/// More than any frame of a range camera; a description that asks for more lies.
constexpr std::uint32_t kMostPayload = 1U << 30U;
constexpr auto kSlice = 50ms;

std::int64_t clock_ns(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return std::int64_t{now.tv_sec} * 1000000000 + now.tv_nsec;
}

/// From Aravis's own thread, which takes packets and puts frames together.
void stream_thread_says(void* /*data*/, ArvStreamCallbackType what, ArvBuffer* /*buffer*/) {
  if (what == ARV_STREAM_CALLBACK_TYPE_INIT) {
    prefer_this_thread(ThreadTakes::kPackets);
  }
}

/// Its pages are there already: were the kernel to clear them as the first packets come, it would not keep up
/// with a fast camera, and the first hundreds of frames would be lost.
ArvBuffer* buffer_in_memory(std::size_t bytes) {
  void* const memory = std::malloc(bytes);
  if (memory == nullptr) {
    return nullptr;
  }
  std::memset(memory, 0xff, bytes);  // zeros would be left to calloc, which leaves them to the kernel
  return arv_buffer_new_full(bytes, memory, memory, std::free);
}

/// What a camera says of bytes behind its rows is believed where there is room for them.
void take_padding_out(ArvBuffer* buffer, const std::uint8_t* pixels, std::size_t rows, std::size_t row_bytes,
                      std::uint64_t payload) {
  gint behind_row = 0;
  gint behind_all = 0;
  arv_buffer_get_image_padding(buffer, &behind_row, &behind_all);
  const std::size_t stride = row_bytes + static_cast<std::size_t>(std::max(behind_row, 0));
  if (stride > row_bytes && stride * (rows - 1) + row_bytes <= payload) {
    close_up_rows(const_cast<std::uint8_t*>(pixels), rows, row_bytes, stride);  // memory of our own
  }
}

}  // namespace

Status Camera::start(std::uint32_t pool) {
  if (stream_ != nullptr) {
    return fail(ErrorKind::kUsage, "the frames are running already", id_);
  }
  // Between two streams a camera may have gone and come back, or this machine slept: it then obeys nobody.
  if (camera_ != nullptr && (*control_lost_ || !has_control())) {
    lose();
  }
  const bool stood = camera_ != nullptr;
  Status begun = begin(pool);
  if (!begun && stood && camera_ == nullptr) {
    begun = begin(pool);  // the connection had died unnoticed
  }
  return begun;
}

Status Camera::begin(std::uint32_t pool) {
  const bool was_gone = camera_ == nullptr;
  if (was_gone) {
    if (const Status connected = connect(); !connected) {
      return connected;
    }
  }
  GErrorHolder error;
  const guint payload = arv_camera_get_payload(camera_, error.fill());
  gint x = 0;
  gint y = 0;
  gint width = 0;
  gint height = 0;
  if (!error) {
    arv_camera_get_region(camera_, &x, &y, &width, &height, error.fill());
  }
  if (error) {
    lose();
    return std::unexpected(error.told("the camera does not tell its frame's size", id_));
  }
  const std::uint64_t needed = std::uint64_t{static_cast<std::uint32_t>(std::max(width, 0))} *
                               static_cast<std::uint32_t>(std::max(height, 0)) * bytes_per_pixel_;
  if (needed == 0 || payload < needed || payload > kMostPayload) {
    return bad_input(id_,
                     "the camera announces " + std::to_string(payload) + " bytes for frames of " +
                         std::to_string(width) + " x " + std::to_string(height),
                     "update its firmware, or ask for a smaller region");
  }
  ArvStream* stream = arv_camera_create_stream(camera_, stream_thread_says, nullptr, error.fill());
  if (stream == nullptr || error) {
    g_clear_object(&stream);
    lose();
    return std::unexpected(error.told("the camera opens no stream", id_));
  }
  if (ARV_IS_GV_STREAM(stream)) {
    g_object_set(stream, "packet-resend",
                 options_.resend ? ARV_GV_STREAM_PACKET_RESEND_ALWAYS : ARV_GV_STREAM_PACKET_RESEND_NEVER,
                 "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
                 static_cast<gint>(kSocketBytes), nullptr);
    say_room(payload);
  }
  const std::uint32_t asked = pool == 0 ? options_.buffers : pool;
  GErrorHolder unknown;  // a camera need not tell its rate
  const double rate_hz = asked == 0 ? arv_camera_get_frame_rate(camera_, unknown.fill()) : 0;
  const std::uint32_t buffers = asked == 0 ? pool_depth(unknown ? 0 : rate_hz, payload, kMostBuffers)
                                           : std::clamp(asked, 2U, kMostBuffers);
  for (std::uint32_t k = 0; k < buffers; ++k) {
    ArvBuffer* const buffer = buffer_in_memory(payload);
    if (buffer == nullptr) {
      g_clear_object(&stream);
      return fail(ErrorKind::kDevice,
                  "this machine has no room for " + std::to_string(buffers) + " frames of " +
                      std::to_string(payload) + " bytes",
                  id_, "ask for fewer with buffers=, or for a smaller region");
    }
    arv_stream_push_buffer(stream, buffer);
  }
  {
    const std::lock_guard lock(mutex_);
    stream_ = stream;
    ended_ = {};
    chunks_ = has_encoder_chunk_ ? arv_camera_create_chunk_parser(camera_) : nullptr;
    payload_ = payload;
    counts_.pool = buffers;
    counts_.reconnections += was_gone ? 1 : 0;
    count_.begin();
    encoder_.begin();
    clock_ =
        CameraClock(ARV_IS_GV_DEVICE(device_) ? latched_offset_ns(ARV_GV_DEVICE(device_)) : std::nullopt);
  }
  if (presence_) {
    presence_->quiet();
  }
  arv_camera_start_acquisition(camera_, error.fill());
  if (error) {
    lose();
    return std::unexpected(error.told("the stream does not start", id_));
  }
  return {};
}

void Camera::say_room(std::uint64_t payload) {
  if (std::exchange(said_room_, true) || (options_.packet_socket && may_take_raw_packets())) {
    return;
  }
  const auto granted = granted_bytes(kSocketBytes);
  if (const auto scarce = granted ? scarce_room(*granted, payload) : std::nullopt) {
    log_warning(id_ + ": " + *scarce);
  }
}

Result<std::optional<Taken>> Camera::next(Clock::time_point until) {
  if (stream_ == nullptr) {
    return camera_ == nullptr ? gone()
                              : fail(ErrorKind::kUsage, "no frames are running", id_, "start them first");
  }
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::microseconds>(
        std::clamp<Clock::duration>(until - Clock::now(), 0us, kSlice));
    ArvBuffer* buffer = arv_stream_timeout_pop_buffer(stream_, static_cast<guint64>(left.count()));
    if (buffer == nullptr) {
      const bool silent = presence_ && presence_->gone();
      if (silent || (*control_lost_ && !presence_)) {
        lose();
        return gone();
      }
      if (*control_lost_ && presence_->has_answered()) {
        if (const Status again = retake(); !again) {
          return std::unexpected(again.error());
        }
        continue;
      }
      if (Clock::now() >= until) {
        return std::nullopt;
      }
      continue;
    }
    // A frame of which packets are missing is a frame that did not come: Aravis may not even have its head,
    // and nobody can tell which of its rows are of the frame before.
    bool ours = arv_buffer_get_status(buffer) == ARV_BUFFER_STATUS_SUCCESS;
    Taken out;
    std::size_t size = 0;
    if (ours) {
      out.width = static_cast<std::uint32_t>(std::max(arv_buffer_get_image_width(buffer), 0));
      out.height = static_cast<std::uint32_t>(std::max(arv_buffer_get_image_height(buffer), 0));
      out.pixels = static_cast<const std::uint8_t*>(arv_buffer_get_image_data(buffer, &size));
      ours = arv_buffer_get_image_pixel_format(buffer) == pixel_format_ && out.width > 0 && out.height > 0 &&
             out.pixels != nullptr && std::uint64_t{out.width} * out.height * bytes_per_pixel_ <= payload_;
    }
    if (presence_) {
      presence_->quiet();
    }
    if (!ours) {
      arv_stream_push_buffer(stream_, buffer);
      continue;
    }
    out.size = std::size_t{out.width} * out.height * bytes_per_pixel_;
    const std::size_t planes = range_ != nullptr && range_->planar ? range_->coordinates() : 1U;
    take_padding_out(buffer, out.pixels, out.height * planes,
                     std::size_t{out.width} * bytes_per_pixel_ / planes, payload_);
    out.offset_x = static_cast<std::uint32_t>(std::max(arv_buffer_get_image_x(buffer), 0));
    out.offset_y = static_cast<std::uint32_t>(std::max(arv_buffer_get_image_y(buffer), 0));
    const std::int64_t now = clock_ns(CLOCK_MONOTONIC);
    const std::int64_t arrived =
        now - (clock_ns(CLOCK_REALTIME) - static_cast<std::int64_t>(arv_buffer_get_system_timestamp(buffer)));
    out.device_timestamp_ns = static_cast<std::int64_t>(arv_buffer_get_timestamp(buffer));
    out.timestamp_ns = std::min(arrived, now);
    if (out.device_timestamp_ns > 0) {
      out.timestamp_ns = clock_.ours(out.device_timestamp_ns, out.timestamp_ns);
    }
    // It came with its first packet, and had a period for the others.
    const std::optional<double> period_ns = count_.period_ns();
    out.late = period_ns && static_cast<double>(now - arrived) > 2 * *period_ns;
    const FrameCount::Step step =
        count_.take(arv_buffer_get_frame_id(buffer), out.timestamp_ns, out.device_timestamp_ns);
    out.id = step.id;
    out.lost = step.lost;
    out.camera_restarted = step.camera_restarted;
    if (out.camera_restarted) {
      encoder_.begin();
    }
    if (chunks_ != nullptr && arv_buffer_has_chunks(buffer)) {
      GErrorHolder error;
      const gint64 count =
          arv_chunk_parser_get_integer_value(chunks_, buffer, "ChunkEncoderValue", error.fill());
      if (!error) {
        out.encoder = encoder_.take(count);
      }
    }
    const std::lock_guard lock(mutex_);
    out.lease = ++last_lease_;
    lent_.emplace(out.lease, buffer);
    ++counts_.delivered;
    counts_.lost += out.lost;
    counts_.late += out.late ? 1 : 0;
    return out;
  }
}

void Camera::give_back(std::uint64_t lease) {
  const std::lock_guard lock(mutex_);
  if (const auto lent = lent_.extract(lease)) {
    arv_stream_push_buffer(stream_, lent.mapped());
  } else if (const auto stale = stale_.extract(lease)) {
    g_object_unref(stale.mapped());
  }
}

void Camera::add_statistics(dubsar_frame_counters& to) const {
  if (stream_ != nullptr && ARV_IS_GV_STREAM(stream_)) {
    guint64 resent = 0;
    guint64 missing = 0;
    arv_gv_stream_get_statistics(ARV_GV_STREAM(stream_), &resent, &missing);
    to.resent += resent;
    guint64 completed = 0;
    guint64 failures = 0;
    guint64 underruns = 0;
    arv_stream_get_statistics(stream_, &completed, &failures, &underruns);
    to.starved += underruns;
  }
}

Status Camera::stop() {
  if (stream_ == nullptr) {
    return {};
  }
  if (*control_lost_ || (presence_ && presence_->gone())) {
    lose();
    return ended();
  }
  GErrorHolder error;
  arv_camera_stop_acquisition(camera_, error.fill());
  const std::lock_guard lock(mutex_);
  ended_ = error ? std::unexpected(error.told("the camera does not end its stream", id_)) : Status{};
  add_statistics(counts_);
  stale_.merge(lent_);
  lent_.clear();
  g_clear_object(&chunks_);
  g_clear_object(&stream_);
  return ended_;
}

Status Camera::ended() {
  const std::lock_guard lock(mutex_);
  return ended_;
}

Camera::~Camera() {
  [[maybe_unused]] const Status said = stop();
  for (const auto& [lease, buffer] : stale_) {
    g_object_unref(buffer);
  }
  g_clear_object(&camera_);
}

Status Camera::trigger() {
  if (camera_ == nullptr) {
    return gone();
  }
  GErrorHolder error;
  arv_camera_software_trigger(camera_, error.fill());
  return error ? std::unexpected(error.told("the camera cannot be triggered", id_)) : Status{};
}

dubsar_frame_counters Camera::counters() {
  const std::lock_guard lock(mutex_);
  dubsar_frame_counters out = counts_;
  add_statistics(out);
  out.struct_size = sizeof out;
  return out;
}

}  // namespace dubsar::aravis
