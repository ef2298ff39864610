// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A camera's features as typed settings.
#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>

#include "drivers/aravis/camera.h"
#include "drivers/aravis/glib.h"
#include "drivers/plugin.h"

namespace dubsar::aravis {

namespace {

struct Known {
  const char* key;
  const char* help;
  const char* unit;
  const char* names[2];  ///< of the SFNC, newer before older
};
/// A region has to have its size before it can go from the sensor's corner, and its size and the exposure say
/// what rates there are.
constexpr Known kKnown[] = {
    {"width_px", "of the region", "px", {"Width", nullptr}},
    {"height_px", "of the region", "px", {"Height", nullptr}},
    {"offset_x_px", "of the region on the sensor", "px", {"OffsetX", nullptr}},
    {"offset_y_px", "of the region on the sensor", "px", {"OffsetY", nullptr}},
    {"exposure_us", "exposure of a frame", "us", {"ExposureTime", "ExposureTimeAbs"}},
    {"gain_db", "gain", "dB", {"Gain", nullptr}},
    {"gain_raw", "gain, in steps of the camera's own", "", {"GainRaw", nullptr}},
    {"frame_rate_hz", "frames per second", "Hz", {"AcquisitionFrameRate", "AcquisitionFrameRateAbs"}},
    {"line_rate_hz", "profiles per second", "Hz", {"AcquisitionLineRate", nullptr}},
    {"light", "power of the camera's own laser or lamp", "", {"LightBrightness", nullptr}},
    {"encoder_divider", "counts of the encoder for each profile", "", {"EncoderDivider", nullptr}},
    {"encoder", "count of the encoder now", "", {"EncoderValue", nullptr}},
};
constexpr const char* kTrigger = "trigger";
/// What a camera may do by itself, and then neither takes nor keeps a value of ours.
constexpr std::pair<std::string_view, const char*> kAutomatics[] = {
    {"exposure_us", "ExposureAuto"}, {"gain_db", "GainAuto"}, {"gain_raw", "GainAuto"}};

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  });
  return text;
}

/// The camera's trigger sources, as it spells them.
std::vector<std::string> trigger_sources(ArvDevice* device) {
  GErrorHolder error;
  guint count = 0;
  const char** names = arv_device_dup_available_enumeration_feature_values_as_strings(device, "TriggerSource",
                                                                                      &count, error.fill());
  std::vector<std::string> out(names, names == nullptr ? names : names + count);
  g_free(names);
  return out;
}

/// The source that a frame waits for, as the camera spells it; empty where it runs free.
std::string trigger_now(ArvDevice* device, GErrorHolder& error) {
  const auto told = [&](const char* name) {
    return text_read(error, [&](GError** e) { return arv_device_get_string_feature_value(device, name, e); });
  };
  const bool waits = arv_device_get_feature(device, "TriggerMode") != nullptr && told("TriggerMode") == "On";
  return waits ? told("TriggerSource") : std::string();
}

/// Aravis knows what must be enabled for it, and ends the camera's trigger on the way, of which nobody spoke.
void set_frame_rate(ArvCamera* camera, double rate_hz, GErrorHolder& error) {
  const std::string trigger = trigger_now(arv_camera_get_device(camera), error);
  if (error) {
    return;
  }
  arv_camera_set_frame_rate(camera, rate_hz, error.fill());
  if (GErrorHolder lost; !trigger.empty()) {
    arv_camera_set_trigger(camera, trigger.c_str(), error ? lost.fill() : error.fill());
  }
}

/// A value set by hand means that the camera is to leave it alone. Cameras without the automatic need
/// nothing.
void end_automatic(ArvDevice* device, const std::string& key, GErrorHolder& error) {
  const auto* found = std::ranges::find(kAutomatics, key, &std::pair<std::string_view, const char*>::first);
  if (found == std::end(kAutomatics) || arv_device_get_feature(device, found->second) == nullptr) {
    return;
  }
  const std::string now = text_read(
      error, [&](GError** e) { return arv_device_get_string_feature_value(device, found->second, e); });
  if (!error && now != "Off") {
    arv_device_set_string_feature_value(device, found->second, "Off", error.fill());
  }
}

}  // namespace

std::vector<Camera::Feature> Camera::features() {
  std::vector<Feature> out;
  if (camera_ == nullptr) {
    return out;
  }
  for (const Known& known : kKnown) {
    for (const char* name : known.names) {
      ArvGcNode* node = name == nullptr ? nullptr : arv_device_get_feature(device_, name);
      if (node == nullptr) {
        continue;
      }
      Feature feature{known.key, known.help, known.unit, name};
      GErrorHolder error;
      if (ARV_IS_GC_FLOAT(node)) {
        arv_device_get_float_feature_bounds(device_, name, &feature.minimum, &feature.maximum, error.fill());
      } else if (ARV_IS_GC_INTEGER(node)) {
        feature.type = DUBSAR_TYPE_INTEGER;
        gint64 low = 1;
        gint64 high = 0;
        arv_device_get_integer_feature_bounds(device_, name, &low, &high, error.fill());
        feature.minimum = static_cast<double>(low);
        feature.maximum = static_cast<double>(high);
      } else {
        continue;
      }
      if (error) {
        feature.minimum = 1;
        feature.maximum = 0;
      }
      feature.writable = std::string_view(known.key) != "encoder";
      out.push_back(feature);
      break;
    }
  }
  if (arv_device_get_feature(device_, "TriggerMode") != nullptr) {
    Feature trigger{kTrigger, "what releases a frame", "", "TriggerSource"};
    trigger.type = DUBSAR_TYPE_CHOICE;
    trigger.choices = "free";
    for (const std::string& source : trigger_sources(device_)) {
      trigger.choices.append("|").append(lower(source));
    }
    out.push_back(trigger);
  }
  Feature format{"pixel_format", "what the camera sends", "", "PixelFormat"};
  format.type = DUBSAR_TYPE_TEXT;
  format.writable = false;
  out.push_back(format);
  return out;
}

Result<dubsar_value> Camera::get(const Feature& feature) {
  if (camera_ == nullptr) {
    return gone();
  }
  dubsar_value out{};
  out.struct_size = sizeof out;
  out.type = feature.type;
  GErrorHolder error;
  switch (feature.type) {
    case DUBSAR_TYPE_NUMBER:
      out.number = arv_device_get_float_feature_value(device_, feature.name.c_str(), error.fill());
      break;
    case DUBSAR_TYPE_INTEGER:
      out.integer = arv_device_get_integer_feature_value(device_, feature.name.c_str(), error.fill());
      break;
    default: {
      std::string text;
      if (feature.key == kTrigger) {
        text = lower(trigger_now(device_, error));
        text = text.empty() ? "free" : text;
      } else {
        text = text_read(error, [&](GError** e) {
          return arv_device_get_string_feature_value(device_, feature.name.c_str(), e);
        });
      }
      plugin::copy_text(out.text, text);
    }
  }
  if (error) {
    return std::unexpected(error.told(feature.key + " cannot be read", id_));
  }
  return out;
}

Status Camera::set(const Feature& feature, const dubsar_value& value) {
  if (camera_ == nullptr) {
    return gone();
  }
  if (stream_ != nullptr && (feature.key.ends_with("_px") || feature.key == kTrigger)) {
    return fail(ErrorKind::kUsage, feature.key + " cannot change while frames run", id_,
                "stop the frames first");
  }
  GErrorHolder error;
  end_automatic(device_, feature.key, error);
  if (error) {
    return std::unexpected(error.told("the camera goes on setting " + feature.key + " by itself", id_));
  }
  const char* name = feature.name.c_str();
  if (feature.key == kTrigger) {
    if (std::string_view(value.text) == "free") {
      arv_camera_clear_triggers(camera_, error.fill());
    } else {
      const std::vector<std::string> sources = trigger_sources(device_);
      const auto source = std::ranges::find(sources, std::string(value.text), lower);
      if (source == sources.end()) {
        return fail(ErrorKind::kUsage, "no such trigger", id_, feature.choices);
      }
      arv_camera_set_trigger(camera_, source->c_str(), error.fill());
    }
  } else if (feature.type == DUBSAR_TYPE_NUMBER) {
    if (feature.key == "frame_rate_hz") {
      set_frame_rate(camera_, value.number, error);
    } else {
      arv_device_set_float_feature_value(device_, name, value.number, error.fill());
    }
  } else {
    arv_device_set_integer_feature_value(device_, name, value.integer, error.fill());
  }
  if (error) {
    return std::unexpected(error.told(feature.key + " cannot be set", id_));
  }
  set_here_[feature.key] = value;
  return {};
}

}  // namespace dubsar::aravis
