// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What an emulated camera is and offers: its answers to the ioctls. Its stream is in virtual_camera.cpp.
#include <algorithm>
#include <cerrno>
#include <cstring>

#include "tests/drivers/peers/virtual_camera.h"
#include "tests/drivers/peers/virtual_picture.h"

namespace dubsar::test {

namespace {

template <std::size_t N>
void put(unsigned char (&to)[N], const std::string& text) {
  std::memcpy(to, text.c_str(), std::min(text.size() + 1, N));
}

}  // namespace

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
  // What is cut has the size that it was cut to.
  const Mode got = crop_step_ != 0 ? now_ : mode == modes_.end() ? modes_.front() : *mode;
  if (keep) {
    now_ = got;
  }
  pix = {};
  pix.width = got.width;
  pix.height = got.height;
  pix.pixelformat = got.fourcc;
  pix.field = V4L2_FIELD_NONE;
  pix.bytesperline = (stretched_ ? 16U : 1U) * picture_line_bytes(got.fourcc, got.width);
  pix.sizeimage = pix.bytesperline * got.height;
  pix.colorspace = V4L2_COLORSPACE_SRGB;
  return 0;
}

/// A sensor whose first lines and columns are dark, and which does not scale.
int VirtualCamera::selection(bool set, v4l2_selection& selection) {
  constexpr std::int32_t kDarkColumns = 8;
  constexpr std::int32_t kDarkLines = 4;
  const Mode& whole = modes_.front();
  if (crop_step_ == 0) {
    return -ENOTTY;
  }
  if (!set) {
    const bool now = selection.target == V4L2_SEL_TGT_CROP;
    selection.r = now ? v4l2_rect{kDarkColumns + static_cast<std::int32_t>(crop_x_),
                                  kDarkLines + static_cast<std::int32_t>(crop_y_), now_.width, now_.height}
                      : v4l2_rect{kDarkColumns, kDarkLines, whole.width, whole.height};
    return 0;
  }
  if (selection.target != V4L2_SEL_TGT_CROP) {
    return -EINVAL;
  }
  if (streaming_) {
    return -EBUSY;
  }
  const auto stepped = [&](std::int64_t value, std::int64_t most) {
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(value, 0, most) / crop_step_ * crop_step_);
  };
  now_.width = std::max(crop_step_, stepped(selection.r.width, whole.width));
  now_.height = std::max(crop_step_, stepped(selection.r.height, whole.height));
  crop_x_ = stepped(selection.r.left - kDarkColumns, whole.width - now_.width);
  crop_y_ = stepped(selection.r.top - kDarkLines, whole.height - now_.height);
  picture_.clear();
  return this->selection(false, selection);
}

int VirtualCamera::settings(std::uint32_t request, void* argument) {
  struct Known {
    std::uint32_t id;
    const char* name;
    int type, minimum, maximum, fallback;
    int* value;
    bool inactive = false;  ///< while an automatic has it
  };
  const Known all[] = {
      {V4L2_CID_AUTOGAIN, "Gain, Automatic", V4L2_CTRL_TYPE_BOOLEAN, 0, 1, 1, &automatic_gain_},
      {V4L2_CID_GAIN, "Gain", V4L2_CTRL_TYPE_INTEGER, 0, 100, 10, &gain_, automatic_gain_ != 0},
      {V4L2_CID_EXPOSURE_AUTO, "Auto Exposure", V4L2_CTRL_TYPE_MENU, 0, 3, 3, &automatic_},
      {V4L2_CID_EXPOSURE_ABSOLUTE, "Exposure Time, Absolute", V4L2_CTRL_TYPE_INTEGER, 1, 5000, 50, &exposure_,
       automatic_ != V4L2_EXPOSURE_MANUAL},
      {V4L2_CID_FOCUS_ABSOLUTE, "Focus, Absolute", V4L2_CTRL_TYPE_INTEGER, 0, 250, 0, &focus_,
       automatic_focus_ != 0},
      {V4L2_CID_FOCUS_AUTO, "Focus, Automatic Continuous", V4L2_CTRL_TYPE_BOOLEAN, 0, 1, 1,
       &automatic_focus_}};
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
    query.flags = one->inactive ? V4L2_CTRL_FLAG_INACTIVE : 0;
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
  if (control.value < one->minimum || control.value > one->maximum) {
    return -ERANGE;
  }
  if (one->inactive) {
    return -EACCES;  // as uvcvideo since 6.0
  }
  *one->value = control.value;
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
    case VIDIOC_G_SELECTION:
    case VIDIOC_S_SELECTION:
      return selection(request == VIDIOC_S_SELECTION, *static_cast<v4l2_selection*>(argument));
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

}  // namespace dubsar::test
