// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the operator sets of the open device, and sees through its camera, between two scans.
#include "acquisition/setting_words.h"
#include "station/engine_impl.h"

namespace dubsar {

void Engine::Impl::tell_panel() {
  Result<DevicePanel> panel = panel_of(source->device());
  if (!panel) {
    emit(Notice{panel.error().line()});
    return;
  }
  panel->uri = options.device;
  emit(DeviceTells{std::make_shared<const DevicePanel>(std::move(*panel))});
}

Status Engine::Impl::open_settings() {
  Result<SettingWords> kept = kept_settings(*store, options.device);
  if (!kept) {
    emit(Notice{kept.error().line()});
    kept = SettingWords{};
  }
  const bool halted = source->halted().has_value();  // then no lamp goes on; the words stay kept
  if (const std::string refused = halted ? std::string() : put_kept(source->device(), *kept, options.device);
      !refused.empty()) {
    emit(Notice{refused});
  }
  settings = std::move(*kept);
  if (!options.settings.empty()) {
    SettingWords others = options.settings;  // a window gives what is kept once more
    std::erase_if(others,
                  [&](const auto& one) { return std::ranges::find(settings, one) != settings.end(); });
    const Status put = halted ? Status() : put_settings(source->device(), others, options.device);
    if (!put) {
      return put;
    }
    for (const auto& [key, value] : options.settings) {
      put_word(settings, key, value);
    }
  }
  if (const Status own = keep_first_device(); !own) {
    return own;
  }
  tell_panel();
  return {};
}

void Engine::Impl::change_settings() {
  std::vector<ChangeSetting> asked;
  {
    const std::scoped_lock lock(mutex);
    asked.swap(settings_asked);
  }
  for (const ChangeSetting& one : asked) {
    if (source->halted()) {  // no lamp goes on because of a word from before
      emit(Notice{kNotSet});
      break;
    }
    Status put = stream ? stream->put({{one.key, one.word}}, options.device)
                        : put_settings(source->device(), {{one.key, one.word}}, options.device);
    if (put) {
      put = keep_setting(one);
    }
    if (!put) {
      emit(Notice{put.error().line()});
    }
  }
  if (!asked.empty()) {
    tell_panel();
  }
}

void Engine::Impl::tell_unset() {
  const bool any = [&] {
    const std::scoped_lock lock(mutex);
    return !settings_asked.empty();
  }();
  if (any) {
    emit(Notice{kNotSet});
  }
}

void Engine::Impl::end_view() {
  if (stream) {
    stream.reset();
    emit(CameraFrame{});
  }
}

bool Engine::Impl::show_camera() {
  bool wanted = false;
  {
    const std::scoped_lock lock(mutex);
    wanted = watch_asked;
  }
  if (!wanted) {
    end_view();
    return false;
  }
  if (!stream) {
    stream =
        std::make_unique<CameraStream>(source->device(), sink, std::function<bool()>(), source->halt_flag());
  }
  if (const Status shown = stream->show(); !shown) {
    emit(Notice{shown.error().line()});
    end_view();
    const std::scoped_lock lock(mutex);
    watch_asked = false;
    return false;
  }
  return true;
}

}  // namespace dubsar
