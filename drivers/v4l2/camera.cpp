// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/v4l2/camera.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>

#include "core/pool_depth.h"

namespace dubsar::v4l2 {

namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t kMostBuffers = 32;  // VIDEO_MAX_FRAME of the kernel

/// From sysfs, where the device under the camera has one; V4L2 itself knows of none.
std::string serial_of(const std::string& path) {
  std::error_code ignored;
  const fs::path real = fs::canonical(path, ignored);
  const fs::path device = fs::path("/sys/class/video4linux") / real.filename() / "device";
  for (const char* up : {"serial", "../serial"}) {
    std::ifstream file(device / up);
    if (std::string serial; std::getline(file, serial) && !serial.empty()) {
      return serial;
    }
  }
  return {};
}

/// video10 behind video9.
std::vector<fs::path> camera_files(const fs::path& folder) {
  std::vector<std::pair<int, fs::path>> numbered;
  std::error_code ignored;
  for (fs::directory_iterator it(folder, ignored), end; !ignored && it != end; it.increment(ignored)) {
    const std::string name = it->path().filename().string();
    if (name.starts_with("video") && name.size() > 5 && name.size() < 10 &&
        std::ranges::all_of(name.substr(5), [](char c) { return c >= '0' && c <= '9'; })) {
      numbered.emplace_back(std::stoi(name.substr(5)), it->path());
    }
  }
  std::ranges::sort(numbered);
  std::vector<fs::path> out;
  out.reserve(numbered.size());
  for (auto& [number, path] : numbered) {
    out.push_back(std::move(path));
  }
  return out;
}

/// Whether this user has no right to open it.
bool is_forbidden(const fs::path& file) {
  const int fd = ::open(file.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  const bool forbidden = fd < 0 && errno == EACCES;
  if (fd >= 0) {
    ::close(fd);
  }
  return forbidden;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> find_cameras(const fs::path& folder) {
  std::vector<std::pair<std::string, std::string>> out;
  for (const fs::path& file : camera_files(folder)) {
    if (const Result<Node> node = Node::open(file.string())) {
      out.emplace_back(file.string(), node->card());
    } else if (is_forbidden(file)) {
      out.emplace_back(file.string(), error_of(EACCES, {}, {}).line());
    }
  }
  return out;
}

Result<std::unique_ptr<Camera>> Camera::open(const std::string& path, const CameraOptions& options) {
  Result<Node> node = Node::open(path);
  if (!node) {
    return std::unexpected(node.error());
  }
  std::unique_ptr<Camera> out(new Camera());
  out->path_ = path;
  out->options_ = options;
  out->node_ = std::make_unique<Node>(std::move(*node));
  out->card_ = out->node_->card();
  out->bus_ = out->node_->bus();
  out->serial_ = serial_of(path);
  Result<Mode> mode = choose(out->node_->modes(), options.wish, path);
  if (!mode) {
    return std::unexpected(mode.error());
  }
  out->chosen_ = *mode;
  if (const Status configured = out->configure(); !configured) {
    return std::unexpected(configured.error());
  }
  if (const Status fixed = end_autofocus(*out->node_); !fixed) {
    return std::unexpected(fixed.error());
  }
  return out;
}

/// Opens the camera anew, also where it got another number when it was plugged in again.
Status Camera::find_again() {
  std::vector<fs::path> places{path_};
  std::ranges::copy(camera_files(fs::path(path_).parent_path()), std::back_inserter(places));
  Error first{ErrorKind::kDevice, "the camera is not there", path_, "see to its cable"};
  for (std::size_t k = 0; k < places.size(); ++k) {
    Result<Node> node = Node::open(places[k].string());
    if (!node) {
      if (k == 0) {
        first = node.error();
      }
      continue;
    }
    const std::string serial = serial_of(places[k].string());
    if (node->card() != card_ || (serial_.empty() ? node->bus() != bus_ : serial != serial_)) {
      if (k == 0) {
        first = {ErrorKind::kDevice, "another camera is there now: " + node->card(), path_,
                 "plug in again: " + card_};
      }
      continue;
    }
    node_ = std::make_unique<Node>(std::move(*node));
    if (const Status configured = configure(); !configured) {
      node_.reset();
      return configured;
    }
    Status written = end_autofocus(*node_);  // it may have started anew
    written = written ? write_again(*node_, controls_, set_here_) : written;
    if (!written) {
      node_.reset();
    }
    return written;
  }
  return std::unexpected(first);
}

Result<dubsar_value> Camera::get(const Control& control) const {
  if (!node_) {
    return fail(ErrorKind::kDevice, "the camera is gone", path_, "plug it in again, then start its frames");
  }
  return read_control(*node_, control);
}

Status Camera::set(const Control& control, const dubsar_value& value) {
  if (!node_) {
    return fail(ErrorKind::kDevice, "the camera is gone", path_, "plug it in again, then start its frames");
  }
  Status written = write_control(*node_, control, value);
  if (written) {
    set_here_[control.id] = value;
    if (const std::optional<std::uint32_t> left = left_to_camera(*node_, control, value)) {
      set_here_.erase(*left);
    }
  }
  return written;
}

Status Camera::start(std::uint32_t pool) {
  if (stream_) {
    return fail(ErrorKind::kUsage, "the frames are running already", path_);
  }
  const bool was_gone = !node_;
  if (was_gone || generation_ > 0) {
    node_.reset();  // its buffers go with it; those that are lent stay mapped
    if (const Status found = find_again(); !found) {
      return found;
    }
  }
  const std::uint32_t asked = pool == 0 ? options_.buffers : pool;
  const std::uint32_t buffers =
      asked == 0 ? pool_depth(mode_.rate_hz, std::uint64_t{stride_} * mode_.height, kMostBuffers)
                 : std::clamp(asked, 2U, kMostBuffers);
  Result<std::shared_ptr<Stream>> stream = Stream::start(*node_, mode_, limited_range_, stride_, buffers);
  if (!stream) {
    if (!node_->alive()) {
      node_.reset();
    }
    return std::unexpected(stream.error());
  }
  const std::lock_guard lock(mutex_);
  ++generation_;
  stream_ = std::move(*stream);
  pool_ = stream_->pool();
  reconnections_ += was_gone ? 1 : 0;
  return {};
}

Result<std::optional<dubsar_frame>> Camera::next(Stream::Clock::time_point until) {
  if (!stream_) {
    return node_ ? fail(ErrorKind::kUsage, "no frames are running", path_, "start them first")
                 : fail(ErrorKind::kDevice, "the camera is gone", path_, "plug it in again, then go on");
  }
  Result<std::optional<dubsar_frame>> frame = stream_->next(until);
  if (!frame) {
    end_stream();
    node_.reset();
    return frame;
  }
  if (*frame) {
    (*frame)->lease |= std::uint64_t{generation_} << 32U;
    (*frame)->offset_x = region_.x;
    (*frame)->offset_y = region_.y;
  }
  return frame;
}

void Camera::give_back(std::uint64_t lease) {
  const auto buffer = static_cast<std::uint32_t>(lease);
  const auto generation = static_cast<std::uint32_t>(lease >> 32U);
  const std::lock_guard lock(mutex_);
  if (stream_ && generation == generation_) {
    stream_->give_back(buffer);
  } else if (const auto ended = ended_.find(generation); ended != ended_.end()) {
    ended->second->give_back(buffer);
    if (ended->second->lent() == 0) {
      ended_.erase(ended);
    }
  }
}

void Camera::end_stream() {
  const std::lock_guard lock(mutex_);
  if (!stream_) {
    return;
  }
  stream_->stop();
  const Counts counts = stream_->counts();
  past_.delivered += counts.delivered;
  past_.lost += counts.lost;
  past_.late += counts.late;
  past_.incomplete += counts.incomplete;
  if (stream_->lent() > 0) {
    ended_.emplace(generation_, stream_);
  }
  stream_.reset();
}

void Camera::stop() {
  end_stream();
}

dubsar_frame_counters Camera::counters() const {
  const std::lock_guard lock(mutex_);
  const Counts now = stream_ ? stream_->counts() : Counts{};
  dubsar_frame_counters out{};
  out.struct_size = sizeof out;
  out.pool = pool_;
  out.delivered = past_.delivered + now.delivered;
  out.lost = past_.lost + now.lost;
  out.late = past_.late + now.late;
  out.incomplete = past_.incomplete + now.incomplete;
  out.reconnections = reconnections_;
  return out;
}

}  // namespace dubsar::v4l2
