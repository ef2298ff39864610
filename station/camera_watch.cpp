// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/camera_watch.h"

#include <utility>

#include "acquisition/device_uri.h"
#include "acquisition/fresh_frame.h"
#include "acquisition/setting_words.h"
#include "drivers/loader.h"

namespace dubsar {

namespace {

constexpr auto kFrameWait = std::chrono::milliseconds(100);
/// Between two looks at what is wanted of a device without a camera.
constexpr auto kRest = std::chrono::milliseconds(50);

/// Who looks asks again at once; a device that failed is left in peace for this long.
constexpr int kRestsAfterFailure = 40;

}  // namespace

Status CameraStream::show() {
  if (!runs_) {
    const bool is_rig = device_.uri().starts_with("rig:");
    if (is_rig && halted_ != nullptr && !halting_) {
      halting_ = std::make_unique<StopsWhenCancelled>(device_, no_job_, halted_);
    }
    if (const Status started = device_.start_frames(); !started) {
      return started;
    }
    runs_ = true;
    lit_ = is_rig ? std::optional(true) : std::nullopt;
    const Result<DeviceCapabilities> capable = device_.capabilities();
    serial_ = capable ? capable->serial : std::string();
  }
  Result<std::optional<Frame>> frame = std::nullopt;
  if (lit_ && *lit_ != wanted_lit_) {
    if (const Status put = device_.set_laser(0, wanted_lit_ ? 1 : 0); !put) {
      return put;
    }
    lit_ = wanted_lit_;
    // Those that wait were exposed in the light of before.
    frame = fresh_frame(device_, [this] { return stopped_ && stopped_(); });
    if (!frame && frame.error().kind == ErrorKind::kCancelled) {
      frame = std::nullopt;
    }
  } else {
    frame = device_.next_frame(kFrameWait);
  }
  if (!frame) {
    return std::unexpected(frame.error());
  }
  if (*frame && sink_) {
    CameraView view = camera_view_of(**frame);
    view.camera_serial = serial_;
    view.lit = lit_;
    sink_(CameraFrame{std::make_shared<const CameraView>(std::move(view))});
  }
  return {};
}

CameraStream::~CameraStream() {
  if (const Status ended = end(); !ended && sink_) {
    sink_(Notice{ended.error().line()});  // a laser that may be lit
  }
}

Status CameraStream::end() {
  const Status ended = std::exchange(runs_, false) ? device_.stop_frames() : Status{};
  const std::optional<Error> burns = halting_ ? halting_->refused() : std::nullopt;
  halting_.reset();
  return burns ? std::unexpected(*burns) : ended;
}

Status CameraStream::put(const SettingWords& words, const std::string& where) {
  const Status put = put_settings(device_, words, where);
  if (put || !runs_) {
    return put;
  }
  if (const Status ended = end(); !ended) {
    return ended;
  }
  return put_settings(device_, words, where);
}

CameraWatch::CameraWatch(std::string uri, std::function<SettingWords()> words, EventSink sink,
                         std::function<void(const std::string&, const std::string&)> changed)
    : uri_(std::move(uri)),
      sink_(std::move(sink)),
      changed_(std::move(changed)),
      thread_([this, first = std::move(words)] {
        run(first());
        bool is_lost = false;
        {
          const std::scoped_lock lock(mutex_);
          looks_ = false;
          is_lost = !wanted_.empty();
        }
        if (is_lost) {
          sink_(Notice{kNotSet});
        }
        for (int k = 0; k < kRestsAfterFailure && !stopped_; ++k) {
          std::this_thread::sleep_for(kRest);
        }
        ended_ = true;
        sink_(CameraFrame{});
      }) {}

CameraWatch::~CameraWatch() {
  stop();
  thread_.join();
}

bool CameraWatch::change(ChangeSetting wanted) {
  const std::scoped_lock lock(mutex_);
  if (looks_) {
    wanted_.push_back(std::move(wanted));
  }
  return looks_;
}

void CameraWatch::run(const SettingWords& words) {
  const DriverRegistry registry;
  const Result<DeviceUri> uri = parse_device_uri(uri_);
  Result<Device> device = uri ? open_device(*uri, registry) : std::unexpected(uri.error());
  if (!device) {
    sink_(Notice{device.error().line()});
    return;
  }
  if (halted_) {  // while it was opened: no lamp goes on because of a word from before
    return;
  }
  if (const std::string refused = put_kept(*device, words, uri_); !refused.empty()) {
    sink_(Notice{refused});
  }
  watch(*device);
}

void CameraWatch::watch(Device& device) {
  Result<DevicePanel> panel = panel_of(device);
  if (!panel) {
    sink_(Notice{panel.error().line()});
    return;
  }
  sink_(DeviceTells{std::make_shared<const DevicePanel>(*panel)});
  CameraStream stream(
      device, sink_, [this] { return stopped_.load(); }, &halted_);
  while (!stopped_) {
    std::deque<ChangeSetting> wanted;
    {
      const std::scoped_lock lock(mutex_);
      wanted.swap(wanted_);
    }
    for (const ChangeSetting& one : wanted) {
      if (halted_) {
        sink_(Notice{kNotSet});
        return;
      }
      const Status put = stream.put({{one.key, one.word}}, uri_);
      if (put) {
        changed_(one.key, one.word);
      } else {
        sink_(Notice{put.error().line()});
      }
    }
    if (!wanted.empty()) {
      panel = panel_of(device);
      if (panel) {
        sink_(DeviceTells{std::make_shared<const DevicePanel>(*panel)});
      }
    }
    if (!panel || !panel->has_camera) {
      std::this_thread::sleep_for(kRest);
    } else {
      stream.light(lit_);
      if (const Status shown = stream.show(); !shown) {
        sink_(Notice{shown.error().line()});
        return;
      }
    }
  }
}

}  // namespace dubsar
