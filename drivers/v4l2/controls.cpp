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

/// Whether another control, an automatic as a rule, puts it out of use.
bool is_inactive(const Node& node, std::uint32_t id) {
  v4l2_query_ext_ctrl query{};
  query.id = id;
  return node.control(VIDIOC_QUERY_EXT_CTRL, &query) == 0 && (query.flags & V4L2_CTRL_FLAG_INACTIVE) != 0;
}

Status put(const Node& node, std::uint32_t id, std::int32_t count, const std::string& key) {
  v4l2_control set{id, count};
  if (node.control(VIDIOC_S_CTRL, &set) == 0) {
    return {};
  }
  const int refusal = errno;
  if (refusal == ERANGE || refusal == EINVAL) {
    return fail(ErrorKind::kUsage, "the camera refuses this value of " + key, node.path());
  }
  // By its number alone the refusal would be one of rights (EACCES) or of the cable (EIO).
  if (is_inactive(node, id)) {
    return fail(ErrorKind::kUsage, "another setting puts this one out of use: " + key, node.path(),
                "end the camera's automatic of it first");
  }
  return std::unexpected(error_of(refusal, key + " cannot be set", node.path()));
}

/// What a camera may set by itself.
struct Automatic {
  std::uint32_t of, id;
  std::int32_t by_hand;  ///< its value when it does not
  const char* what;
};
constexpr Automatic kAutomatics[] = {
    {V4L2_CID_EXPOSURE_ABSOLUTE, V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL, "manual exposure"},
    {V4L2_CID_GAIN, V4L2_CID_AUTOGAIN, 0, "manual gain"}};

/// A value set by hand means that the camera is to leave it alone. Cameras without the automatic need
/// nothing.
Status end_automatic(const Node& node, std::uint32_t of) {
  const auto* found = std::ranges::find(kAutomatics, of, &Automatic::of);
  v4l2_control now{found == std::end(kAutomatics) ? 0 : found->id, 0};
  if (now.id == 0 || node.control(VIDIOC_G_CTRL, &now) != 0 || now.value == found->by_hand) {
    return {};
  }
  return put(node, found->id, found->by_hand, found->what);
}

Result<std::int32_t> count_of(const Node& node, const Control& control, const dubsar_value& value) {
  if (control.type == DUBSAR_TYPE_NUMBER) {
    return static_cast<std::int32_t>(std::llround(value.number / control.unit_per_count));
  }
  if (control.type != DUBSAR_TYPE_CHOICE) {
    return static_cast<std::int32_t>(value.integer);
  }
  const auto choice =
      std::ranges::find(control.choices, std::string(value.text), &std::pair<std::string, int>::first);
  if (choice == control.choices.end()) {
    return fail(ErrorKind::kUsage, "no such choice of " + control.key, node.path(), control.choice_words());
  }
  return choice->second;
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
  const Result<std::int32_t> count = count_of(node, control, value);
  if (!count) {
    return std::unexpected(count.error());
  }
  if (const Status manual = end_automatic(node, control.id); !manual) {
    return manual;
  }
  return put(node, control.id, *count, control.key);
}

Status end_autofocus(const Node& node) {
  v4l2_control now{V4L2_CID_FOCUS_AUTO, 0};
  return node.control(VIDIOC_G_CTRL, &now) != 0 || now.value == 0
             ? Status{}
             : put(node, V4L2_CID_FOCUS_AUTO, 0, "manual focus");
}

std::optional<std::uint32_t> left_to_camera(const Node& node, const Control& control,
                                            const dubsar_value& value) {
  const auto* automatic = std::ranges::find(kAutomatics, control.id, &Automatic::id);
  return automatic != std::end(kAutomatics) && count_of(node, control, value) != automatic->by_hand
             ? std::optional(automatic->of)
             : std::nullopt;
}

Status write_again(const Node& node, std::span<const Control> controls,
                   const std::map<std::uint32_t, dubsar_value>& values) {
  for (const bool numbers : {false, true}) {
    for (const Control& control : controls) {
      const auto kept = values.find(control.id);
      if (kept == values.end() || control.is_number() != numbers) {
        continue;
      }
      if (const Status manual = end_automatic(node, control.id); !manual) {
        return manual;
      }
      if (is_inactive(node, control.id)) {
        continue;
      }
      if (const Status written = write_control(node, control, kept->second); !written) {
        return written;
      }
    }
  }
  return {};
}

}  // namespace dubsar::v4l2
