// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a camera sends: format, region, rate.
#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cmath>

#include "core/number_text.h"
#include "drivers/v4l2/camera.h"

namespace dubsar::v4l2 {

namespace {

constexpr std::uint32_t kType = V4L2_BUF_TYPE_VIDEO_CAPTURE;
/// Cameras count intervals in whole fractions of a second or of a clock of their own.
constexpr double kRateTolerance = 0.01;

}  // namespace

/// Sets what the camera sends and reads how it lies in a buffer. It has no say in format and size.
Status Camera::put_format(std::uint32_t width, std::uint32_t height) {
  v4l2_format format{};
  format.type = kType;
  format.fmt.pix.width = width;
  format.fmt.pix.height = height;
  format.fmt.pix.pixelformat =
      use_of(chosen_.fourcc).handling == Handling::kConverted ? V4L2_PIX_FMT_YUV420 : chosen_.fourcc;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  const std::uint32_t asked = format.fmt.pix.pixelformat;
  if (node_->control(VIDIOC_S_FMT, &format) != 0) {
    return std::unexpected(error_of(errno, "the camera refuses " + name_of(chosen_.fourcc), path_));
  }
  const v4l2_pix_format& got = format.fmt.pix;
  if (got.pixelformat != asked || got.width != width || got.height != height) {
    return fail(ErrorKind::kDevice,
                "the camera sends " + name_of(got.pixelformat) + " " + std::to_string(got.width) + "x" +
                    std::to_string(got.height) + " when asked for what it offers",
                path_, "choose another ?format= or ?size=");
  }
  constexpr std::uint32_t kMostPixels = 1U << 28U;  // more than any sensor has: it lies
  if (got.width == 0 || got.height == 0 || got.height > kMostPixels / got.width) {
    return bad_input(path_,
                     "the camera announces frames of " + std::to_string(got.width) + " x " +
                         std::to_string(got.height) + " pixels",
                     "ask for another ?size=");
  }
  mode_.width = width;
  mode_.height = height;
  stride_ = std::max(got.bytesperline, got.width * use_of(asked).bytes_per_pixel);
  limited_range_ = has_limited_range(chosen_.fourcc, got.quantization);
  return {};
}

/// The camera has the last word about it.
void Camera::put_rate(double rate_hz) {
  mode_.rate_hz = rate_hz;
  if (!(rate_hz > 0)) {
    return;
  }
  v4l2_streamparm rate{};
  rate.type = kType;
  constexpr std::uint32_t kParts = 1000;
  rate.parm.capture.timeperframe = {kParts, static_cast<std::uint32_t>(std::lround(rate_hz * kParts))};
  if (node_->control(VIDIOC_S_PARM, &rate) == 0 && rate.parm.capture.timeperframe.numerator > 0) {
    mode_.rate_hz = static_cast<double>(rate.parm.capture.timeperframe.denominator) /
                    rate.parm.capture.timeperframe.numerator;
  }
}

/// What was asked for, else the fastest of what is sent.
double Camera::wanted_rate_hz() const {
  if (rate_hz_) {
    return *rate_hz_;
  }
  const bool whole = region_ == Region{} || options_.wish.rate_hz;
  const double fastest = whole ? 0 : node_->fastest_hz(mode_.fourcc, mode_.width, mode_.height);
  return fastest > 0 ? fastest : chosen_.rate_hz;
}

Status Camera::configure() {
  controls_ = controls_of(*node_);  // before libv4l2 adds controls of its own making
  const bool converted = use_of(chosen_.fourcc).handling == Handling::kConverted;
  mode_ = chosen_;
  whole_ = whole_picture(*node_);
  if (converted) {
    if (const Status converts = node_->convert(); !converts) {
      return converts;
    }
  }
  if (const Status put = put_format(chosen_.width, chosen_.height); !put) {
    return put;
  }
  // A picture of another size is scaled or binned: a part of the sensor is then no part of it.
  if (converted || (whole_ && *whole_ != Region{0, 0, chosen_.width, chosen_.height})) {
    whole_.reset();
  }
  if (whole_ && region_ != Region{}) {
    if (const Status put = put_region_and_format(region_); !put) {
      return put;
    }
  }
  put_rate(wanted_rate_hz());
  return {};
}

Status Camera::put_region_and_format(const Region& region) {
  Status put = put_region(*node_, region);
  put = put ? put_format(region.width, region.height) : put;
  if (put && region_now(*node_) != region) {
    put = fail(ErrorKind::kUsage, "the camera moves its region when its size is set", path_,
               "leave the region as it is");
  }
  return put;
}

Status Camera::may_change(const char* what) const {
  if (!node_) {
    return fail(ErrorKind::kDevice, "the camera is gone", path_, "plug it in again, then start its frames");
  }
  return stream_ ? fail(ErrorKind::kUsage, std::string(what) + " cannot change while frames run", path_,
                        "stop the frames first")
                 : Status{};
}

Region Camera::region() const {
  return region_ == Region{} ? Region{0, 0, mode_.width, mode_.height} : region_;
}

Status Camera::set_region(const Region& wanted) {
  if (const Status may = may_change("the region"); !may) {
    return may;
  }
  if (!whole_) {
    return fail(ErrorKind::kUsage, "this camera sends no part of its picture", path_,
                "open it with another ?size=");
  }
  const Region before = region();
  Status put = put_region_and_format(wanted);
  if (!put) {
    if (const Status back = put_region_and_format(before); !back) {
      node_.reset();  // what it sends now nobody knows: the next start opens it anew
    }
    return put;
  }
  region_ = wanted;
  put_rate(wanted_rate_hz());
  return {};
}

Status Camera::set_rate(double rate_hz) {
  if (const Status may = may_change("the rate"); !may) {
    return may;
  }
  put_rate(rate_hz);
  const double got = mode_.rate_hz;
  if (std::abs(got / rate_hz - 1) > kRateTolerance) {
    put_rate(wanted_rate_hz());
    return fail(ErrorKind::kUsage, "the camera does not send " + short_text(rate_hz) + " frames a second",
                path_, "it would send " + short_text(got));
  }
  rate_hz_ = rate_hz;
  return {};
}

}  // namespace dubsar::v4l2
