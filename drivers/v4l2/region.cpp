// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The selection interface of V4L2 ("Cropping, composing and scaling" of the kernel's documentation).
#include "drivers/v4l2/region.h"

#include <linux/videodev2.h>

#include <cerrno>
#include <string>

namespace dubsar::v4l2 {

namespace {

std::optional<v4l2_rect> rectangle(const Node& node, std::uint32_t target) {
  v4l2_selection selection{};
  selection.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  selection.target = target;
  const bool told = node.control(VIDIOC_G_SELECTION, &selection) == 0;
  return told && selection.r.width > 0 && selection.r.height > 0 ? std::optional(selection.r) : std::nullopt;
}

int put(const Node& node, const v4l2_rect& rectangle) {
  v4l2_selection selection{};
  selection.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  selection.target = V4L2_SEL_TGT_CROP;
  selection.r = rectangle;
  return node.control(VIDIOC_S_SELECTION, &selection);
}

std::string described(const Region& region) {
  return std::to_string(region.width) + " x " + std::to_string(region.height) + " from " +
         std::to_string(region.x) + ", " + std::to_string(region.y) + " on";
}

}  // namespace

std::optional<Region> whole_picture(const Node& node) {
  // What it sends by itself need not begin in the corner of the sensor: dark lines lie there.
  const std::optional<v4l2_rect> all = rectangle(node, V4L2_SEL_TGT_CROP_DEFAULT);
  if (!all || !rectangle(node, V4L2_SEL_TGT_CROP) || put(node, *all) != 0) {
    return std::nullopt;
  }
  return Region{0, 0, all->width, all->height};
}

Status put_region(const Node& node, const Region& region) {
  const std::optional<v4l2_rect> all = rectangle(node, V4L2_SEL_TGT_CROP_DEFAULT);
  if (!all || std::uint64_t{region.x} + region.width > all->width ||
      std::uint64_t{region.y} + region.height > all->height) {
    return fail(ErrorKind::kUsage, "the region " + described(region) + " reaches beyond the sensor",
                node.path(), "make it smaller before it goes from the corner");
  }
  const v4l2_rect wanted{all->left + static_cast<std::int32_t>(region.x),
                         all->top + static_cast<std::int32_t>(region.y), region.width, region.height};
  if (put(node, wanted) != 0) {
    return std::unexpected(error_of(errno, "the camera refuses the region", node.path()));
  }
  const std::optional<Region> got = region_now(node);
  if (!got || *got != region) {
    return fail(ErrorKind::kUsage, "the camera does not send the region " + described(region), node.path(),
                got ? "it can send " + described(*got) : std::string("leave the region as it is"));
  }
  return {};
}

std::optional<Region> region_now(const Node& node) {
  const std::optional<v4l2_rect> all = rectangle(node, V4L2_SEL_TGT_CROP_DEFAULT);
  const std::optional<v4l2_rect> now = rectangle(node, V4L2_SEL_TGT_CROP);
  if (!all || !now || now->left < all->left || now->top < all->top) {
    return std::nullopt;
  }
  return Region{static_cast<std::uint32_t>(now->left - all->left),
                static_cast<std::uint32_t>(now->top - all->top), now->width, now->height};
}

}  // namespace dubsar::v4l2
