// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "acquisition/stops_when_cancelled.h"
#include "core/job.h"
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
  /// The emergency stop: likewise, and a rig's laser goes off wherever its camera is.
  void halt() {
    halted_ = true;
    stop();
  }
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
  std::atomic<bool> halted_ = false;
  std::atomic<bool> stopped_ = false;
  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

/// A camera's stream while a person looks at it; ends it when it goes, and says in a Notice what went wrong
/// with that.
class CameraStream {
 public:
  /// Once stopped() is true (if it is given), show() waits for nothing any more. Once `halted` is (likewise),
  /// a rig's emergency stop is said, whatever its camera does: one that is gone, or looked for again, comes
  /// back after seconds, and its laser would shine for as long.
  CameraStream(Device& device, const EventSink& sink, std::function<bool()> stopped = {},
               const std::atomic<bool>* halted = nullptr)
      : device_(device), sink_(sink), stopped_(std::move(stopped)), halted_(halted) {}
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
  const std::atomic<bool>* halted_;
  JobContext no_job_;                            ///< there is none that could be cancelled
  std::unique_ptr<StopsWhenCancelled> halting_;  ///< of a rig, from before its laser is lit
  bool runs_ = false;
  bool wanted_lit_ = true;
  std::optional<bool> lit_;  ///< nothing: not of a rig
  std::string serial_;
};

}  // namespace dubsar
