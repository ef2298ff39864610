// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "station/device_panel.h"
#include "station/event.h"
#include "station/operator_command.h"

namespace dubsar {

/// Looks through a device on a thread of its own while nothing else uses it: its settings and its camera's
/// frames, as DeviceTells, CameraFrame and Notice. Ends by itself where the device cannot be opened or is
/// gone.
class CameraWatch {
 public:
  /// `words` are put first; they are asked for on the thread of the watch. `changed` is called there after a
  /// setting was changed.
  CameraWatch(std::string uri, std::function<SettingWords()> words, EventSink sink,
              std::function<void(const std::string& key, const std::string& word)> changed);
  /// Waits until the device is closed.
  ~CameraWatch();
  CameraWatch(const CameraWatch&) = delete;
  CameraWatch& operator=(const CameraWatch&) = delete;

  /// False where it looks no more, and nothing is changed.
  [[nodiscard]] bool change(ChangeSetting wanted);
  /// Of a rig: whether its laser is on, as it is unless said; CameraView::lit says from when on.
  void light(bool on) { lit_ = on; }
  void stop() { stopped_ = true; }  ///< returns at once; `ended` follows
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  void run(const SettingWords& words);
  void watch(Device& device);
  std::string uri_;
  EventSink sink_;
  std::function<void(const std::string&, const std::string&)> changed_;
  std::mutex mutex_;
  std::deque<ChangeSetting> wanted_;
  bool looks_ = true;  ///< and takes what is wanted
  std::atomic<bool> lit_ = true;
  std::atomic<bool> stopped_ = false;
  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

/// A camera's stream while a person looks at it; ends it when it goes, and says in a Notice what went wrong
/// with that.
class CameraStream {
 public:
  /// Once stopped() is true (if it is given), show() waits for nothing any more.
  CameraStream(Device& device, const EventSink& sink, std::function<bool()> stopped = {})
      : device_(device), sink_(sink), stopped_(std::move(stopped)) {}
  ~CameraStream();
  CameraStream(const CameraStream&) = delete;
  CameraStream& operator=(const CameraStream&) = delete;

  /// The next frame, if one comes within a tenth of a second, as CameraFrame. Starts the stream where needed.
  Status show();
  /// kDevice: a laser that may be lit, a camera that is gone.
  Status end();
  /// Of a rig: with the laser on (unless said) or off, from the next show() on.
  void light(bool on) { wanted_lit_ = on; }
  /// Changes settings. What a camera cannot change while frames run ends them; the next show() starts them
  /// again.
  Status put(const SettingWords& words, const std::string& where);

 private:
  Device& device_;
  const EventSink& sink_;
  std::function<bool()> stopped_;
  bool runs_ = false;
  bool wanted_lit_ = true;
  std::optional<bool> lit_;  ///< nothing: not of a rig
  std::string serial_;
};

}  // namespace dubsar
