// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/v4l2/controls.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "drivers/plugin.h"

namespace dubsar::v4l2 {

namespace {

/// A camera whose list goes round must not keep us for ever.
constexpr int kMostControls = 512;
/// V4L2_CID_EXPOSURE_ABSOLUTE counts in 100 us.
constexpr double kExposureUnitUs = 100;

template <class Text>
std::string text_of(const Text& field) {
  const auto* begin = reinterpret_cast<const char*>(&field[0]);
  return {begin, ::strnlen(begin, sizeof field)};
}

void add_choices(const Node& node, const v4l2_query_ext_ctrl& query, Control& to) {
  constexpr std::int64_t kMost = 64;
  for (std::int64_t k = query.minimum; k <= std::min(query.maximum, query.minimum + kMost); ++k) {
    v4l2_querymenu entry{};
    entry.id = query.id;
    entry.index = static_cast<std::uint32_t>(k);
    if (node.control(VIDIOC_QUERYMENU, &entry) != 0) {
      continue;  // menus have holes
    }
    std::string word =
        query.type == V4L2_CTRL_TYPE_MENU ? text_of(entry.name) : std::to_string(std::int64_t{entry.value});
    std::ranges::replace(word, '|', '/');
    to.choices.emplace_back(std::move(word), static_cast<std::int32_t>(k));
  }
}

/// Empty for a control that makes no setting.
std::vector<Control> setting_of(const Node& node, const v4l2_query_ext_ctrl& query) {
  Control out;
  out.id = query.id;
  out.help = text_of(query.name);
  out.key = key_from(out.help);
  if ((query.flags & (V4L2_CTRL_FLAG_DISABLED | V4L2_CTRL_FLAG_HAS_PAYLOAD)) != 0 || out.key.empty()) {
    return {};
  }
  switch (query.type) {
    case V4L2_CTRL_TYPE_INTEGER:
      out.type = DUBSAR_TYPE_INTEGER;
      break;
    case V4L2_CTRL_TYPE_BOOLEAN:
      out.type = DUBSAR_TYPE_BOOL;
      break;
    case V4L2_CTRL_TYPE_MENU:
    case V4L2_CTRL_TYPE_INTEGER_MENU:
      out.type = DUBSAR_TYPE_CHOICE;
      add_choices(node, query, out);
      break;
    default:
      return {};
  }
  out.minimum = static_cast<double>(query.minimum);
  out.maximum = static_cast<double>(query.maximum);
  out.step = static_cast<double>(query.step);
  if (query.id == V4L2_CID_EXPOSURE_ABSOLUTE) {
    out.key = "exposure_us";
    out.help = "exposure of a frame";
    out.unit = "us";
    out.type = DUBSAR_TYPE_NUMBER;
    out.unit_per_count = kExposureUnitUs;
    out.minimum *= kExposureUnitUs;
    out.maximum *= kExposureUnitUs;
    out.step *= kExposureUnitUs;
  } else if (query.id == V4L2_CID_GAIN) {
    out.key = "gain";
  }
  if ((query.flags & V4L2_CTRL_FLAG_WRITE_ONLY) == 0) {
    out.flags |= DUBSAR_SETTING_READABLE;
  }
  if ((query.flags & V4L2_CTRL_FLAG_READ_ONLY) == 0) {
    out.flags |= DUBSAR_SETTING_WRITABLE;
  }
  return {out};
}

Status put(const Node& node, std::uint32_t id, std::int32_t count, const std::string& key) {
  v4l2_control set{id, count};
  if (node.control(VIDIOC_S_CTRL, &set) == 0) {
    return {};
  }
  if (errno == ERANGE || errno == EINVAL) {
    return fail(ErrorKind::kUsage, "the camera refuses this value of " + key, node.path());
  }
  return std::unexpected(error_of(errno, key + " cannot be set", node.path()));
}

/// A value set by hand means that the camera is to leave it alone. Cameras without the automatic need
/// nothing.
Status end_automatic(const Node& node, std::uint32_t id, std::int32_t by_hand, const std::string& what) {
  v4l2_control now{id, 0};
  if (node.control(VIDIOC_G_CTRL, &now) != 0 || now.value == by_hand) {
    return {};
  }
  return put(node, id, by_hand, what);
}

}  // namespace

std::string Control::choice_words() const {
  std::string out;
  for (const auto& [word, value] : choices) {
    out += (out.empty() ? "" : "|") + word;
  }
  return out;
}

std::string key_from(const std::string& name) {
  std::string out;
  for (const char c : name) {
    const bool small = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    const bool capital = c >= 'A' && c <= 'Z';
    if (small || capital) {
      out += capital ? static_cast<char>(c - 'A' + 'a') : c;
    } else if (!out.empty() && out.back() != '_') {
      out += '_';
    }
  }
  while (!out.empty() && out.back() == '_') {
    out.pop_back();
  }
  return out;
}

std::vector<Control> controls_of(const Node& node) {
  std::vector<Control> out;
  v4l2_query_ext_ctrl query{};
  query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  for (int k = 0; k < kMostControls && node.control(VIDIOC_QUERY_EXT_CTRL, &query) == 0; ++k) {
    for (Control& control : setting_of(node, query)) {
      if (std::ranges::find(out, control.key, &Control::key) == out.end()) {
        out.push_back(std::move(control));
      }
    }
    const std::uint32_t next = query.id | V4L2_CTRL_FLAG_NEXT_CTRL;
    query = {};
    query.id = next;
  }
  return out;
}

Result<dubsar_value> read_control(const Node& node, const Control& control) {
  v4l2_control now{control.id, 0};
  if (node.control(VIDIOC_G_CTRL, &now) != 0) {
    return std::unexpected(error_of(errno, control.key + " cannot be read", node.path()));
  }
  dubsar_value out{};
  out.struct_size = sizeof out;
  out.type = control.type;
  out.integer = now.value;
  out.number = now.value * control.unit_per_count;
  const auto choice = std::ranges::find(control.choices, now.value, &std::pair<std::string, int>::second);
  if (choice != control.choices.end()) {
    plugin::copy_text(out.text, choice->first);
  }
  return out;
}

Status write_control(const Node& node, const Control& control, const dubsar_value& value) {
  std::int64_t count = value.integer;
  if (control.type == DUBSAR_TYPE_NUMBER) {
    count = std::llround(value.number / control.unit_per_count);
  } else if (control.type == DUBSAR_TYPE_CHOICE) {
    const auto choice =
        std::ranges::find(control.choices, std::string(value.text), &std::pair<std::string, int>::first);
    if (choice == control.choices.end()) {
      return fail(ErrorKind::kUsage, "no such choice of " + control.key, node.path(), control.choice_words());
    }
    count = choice->second;
  }
  Status manual;
  if (control.id == V4L2_CID_EXPOSURE_ABSOLUTE) {
    manual = end_automatic(node, V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL, "manual exposure");
  } else if (control.id == V4L2_CID_GAIN) {
    manual = end_automatic(node, V4L2_CID_AUTOGAIN, 0, "manual gain");
  }
  if (!manual) {
    return manual;
  }
  return put(node, control.id, static_cast<std::int32_t>(count), control.key);
}

}  // namespace dubsar::v4l2
