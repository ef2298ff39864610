// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/v4l2/node.h"

#include <fcntl.h>
#include <libv4l2.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "drivers/plugin.h"

namespace dubsar::v4l2 {

namespace {

constexpr std::uint32_t kType = V4L2_BUF_TYPE_VIDEO_CAPTURE;
/// A camera that lies about its lists must not keep us for ever.
constexpr std::uint32_t kMostEntries = 256;

template <std::size_t N>
std::string text_of(const unsigned char (&field)[N]) {
  const auto* begin = reinterpret_cast<const char*>(field);
  return {begin, ::strnlen(begin, N)};
}

double rate_of(const v4l2_fract& interval) {
  return interval.numerator > 0 ? static_cast<double>(interval.denominator) / interval.numerator : 0.0;
}

void add_sizes(const Node& node, std::uint32_t fourcc, std::vector<Mode>& to) {
  for (std::uint32_t k = 0; k < kMostEntries; ++k) {
    v4l2_frmsizeenum size{};
    size.index = k;
    size.pixel_format = fourcc;
    if (node.control(VIDIOC_ENUM_FRAMESIZES, &size) != 0) {
      break;
    }
    const bool discrete = size.type == V4L2_FRMSIZE_TYPE_DISCRETE;
    const std::uint32_t width = discrete ? size.discrete.width : size.stepwise.max_width;
    const std::uint32_t height = discrete ? size.discrete.height : size.stepwise.max_height;
    to.push_back({fourcc, width, height, node.fastest_hz(fourcc, width, height)});
    if (!discrete) {
      break;
    }
  }
}

}  // namespace

bool means_gone(int number) {
  return number == ENODEV || number == ENXIO || number == ENOTCONN || number == ESHUTDOWN ||
         number == EPIPE || number == ENOENT || number == ECONNABORTED;
}

Error error_of(int number, const std::string& doing, const std::string& path) {
  switch (number) {
    case EACCES:
    case EPERM:
      return {ErrorKind::kDevice, "no right to use the camera", path,
              "join the group video, or copy 60-dubsar.rules to /etc/udev/rules.d; then plug the camera in "
              "again"};
    case EBUSY:
      return {ErrorKind::kDevice, "the camera is in use by another program", path,
              "close whatever shows its picture, then try again"};
    case ENOTTY:
      return {ErrorKind::kDevice, "not a camera of this kind", path, "dubsar drivers lists those that are"};
    default:
      break;
  }
  if (means_gone(number)) {
    return {ErrorKind::kDevice, "the camera is not there", path,
            "see to its cable; dubsar drivers lists those that are"};
  }
  return {ErrorKind::kDevice, doing + ": " + std::strerror(number), path, "plug the camera in again"};
}

Result<Node> Node::open(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) {
    return std::unexpected(error_of(errno, "the camera cannot be opened", path));
  }
  Node node(path, fd);
  v4l2_capability can{};
  if (node.control(VIDIOC_QUERYCAP, &can) != 0) {
    return std::unexpected(error_of(errno == EINVAL ? ENOTTY : errno, "the camera does not answer", path));
  }
  const std::uint32_t flags =
      (can.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? can.device_caps : can.capabilities;
  if ((flags & V4L2_CAP_VIDEO_CAPTURE) == 0 || (flags & V4L2_CAP_STREAMING) == 0) {
    return fail(ErrorKind::kDevice, "not a camera that streams", path, "dubsar drivers lists those that do");
  }
  node.card_ = text_of(can.card);
  node.bus_ = text_of(can.bus_info);
  return node;
}

Node::Node(Node&& other) noexcept
    : path_(std::move(other.path_)),
      card_(std::move(other.card_)),
      bus_(std::move(other.bus_)),
      fd_(std::exchange(other.fd_, -1)),
      converts_(other.converts_) {}

Node::~Node() {
  if (fd_ >= 0) {
    converts_ ? ::v4l2_close(fd_) : ::close(fd_);
  }
}

int Node::control(unsigned long request, void* argument) const {
  int answer = 0;
  do {
    answer = converts_ ? ::v4l2_ioctl(fd_, request, argument) : ::ioctl(fd_, request, argument);
  } while (answer < 0 && errno == EINTR);
  return answer;
}

void* Node::map(std::size_t length, std::int64_t offset) const {
  constexpr int kAccess = PROT_READ | PROT_WRITE;  // some drivers refuse one without the other
  return converts_ ? ::v4l2_mmap(nullptr, length, kAccess, MAP_SHARED, fd_, offset)
                   : ::mmap(nullptr, length, kAccess, MAP_SHARED, fd_, offset);
}

void Node::unmap(void* at, std::size_t length) const {
  converts_ ? ::v4l2_munmap(at, length) : ::munmap(at, length);
}

Status Node::convert() {
  if (::v4l2_fd_open(fd_, 0) < 0) {
    return std::unexpected(error_of(errno, "libv4l2 cannot convert what it sends", path_));
  }
  converts_ = true;
  return {};
}

bool Node::alive() const {
  v4l2_capability can{};
  return ::ioctl(fd_, VIDIOC_QUERYCAP, &can) == 0 || !means_gone(errno);
}

double Node::fastest_hz(std::uint32_t fourcc, std::uint32_t width, std::uint32_t height) const {
  double best = 0;
  for (std::uint32_t k = 0; k < kMostEntries; ++k) {
    v4l2_frmivalenum interval{};
    interval.index = k;
    interval.pixel_format = fourcc;
    interval.width = width;
    interval.height = height;
    if (control(VIDIOC_ENUM_FRAMEINTERVALS, &interval) != 0) {
      break;
    }
    if (interval.type != V4L2_FRMIVAL_TYPE_DISCRETE) {
      return rate_of(interval.stepwise.min);
    }
    best = std::max(best, rate_of(interval.discrete));
  }
  return best;
}

std::vector<Mode> Node::modes() const {
  std::vector<Mode> out;
  for (std::uint32_t k = 0; k < kMostEntries; ++k) {
    v4l2_fmtdesc format{};
    format.index = k;
    format.type = kType;
    if (control(VIDIOC_ENUM_FMT, &format) != 0) {
      break;
    }
    const std::size_t before = out.size();
    add_sizes(*this, format.pixelformat, out);
    if (out.size() == before) {  // it names no sizes: the present one, then
      v4l2_format now{};
      now.type = kType;
      if (control(VIDIOC_G_FMT, &now) == 0) {
        out.push_back({format.pixelformat, now.fmt.pix.width, now.fmt.pix.height, 0});
      }
    }
  }
  return out;
}

}  // namespace dubsar::v4l2
