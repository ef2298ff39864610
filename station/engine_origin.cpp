// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the session keeps of what the tablet was scanned with: device, settings, rig, calibration, pins. A run
// that stores no scan (a wrong address, a wrong unit, nothing before the scanner) changes none of it: who
// reads the package later takes it for the source of the scans.
#include "acquisition/device_uri.h"
#include "acquisition/told_device.h"
#include "station/engine_impl.h"
#include "station/range_camera_record.h"

namespace dubsar {

Status Engine::Impl::keep_first_device() {
  const auto scans = store->scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  const std::scoped_lock lock(origin_mutex);
  const bool is_first = scans->empty() && left_scans(store->folder()).empty();
  if (!is_first && options.settings.empty()) {
    return {};
  }
  const Result<std::string> own = own_device(*store);
  if (!own) {  // where nothing was to be kept, what stands there stays; it was said
    return options.settings.empty() ? Status() : std::unexpected(own.error());
  }
  return is_first ? save_device() : Status();
}

Status Engine::Impl::keep_setting(const ChangeSetting& set) {
  const std::scoped_lock lock(origin_mutex);
  put_word(settings, set.key, set.word);
  return origin_kept ? keep_settings(*store, options.device, settings)
                     : note_settings(*store, options.device, settings);
}

Status Engine::Impl::save_device() {
  const Result<std::string> own = own_device(*store);  // where that cannot be read, it was said
  if (!options.settings.empty() || (own && *own != absolute_device(options.device))) {
    return keep_settings(*store, options.device, settings);
  }
  return {};
}

Status Engine::Impl::save_pins() {
  if (std::exchange(pins_kept, true) || !options.pins) {
    return {};
  }
  return store->save_document("pins", pins_to_json(*options.pins));
}

Status Engine::Impl::save_origin() {
  if (std::exchange(origin_kept, true)) {
    return {};
  }
  if (rig) {
    if (const Status saved = store->save_document("rig", rig_to_json(*rig)); !saved) {
      return saved;
    }
  }
  if (calibration) {
    if (const Status kept = keep_calibration(*store, *calibration); !kept) {
      return kept;
    }
  }
  if (const Status saved = keep_range_camera(*store, options.device); !saved) {
    return saved;
  }
  if (const Status saved = save_device(); !saved) {
    return saved;
  }
  return save_pins();
}

void Engine::Impl::keep_origin() {
  const Status saved = [this] {
    const std::scoped_lock lock(origin_mutex);
    return save_origin();
  }();
  if (!saved) {
    give_up(saved.error());
  }
}

Status Engine::Impl::keep_origin_of_left_rows() {
  const std::scoped_lock lock(origin_mutex);
  const Result<std::string> own = own_device(*store);
  return own && *own == absolute_device(options.device) ? save_origin() : Status();
}

void Engine::Impl::keep_pins_of(KnownAs::Kind known) {
  if (known != KnownAs::Kind::kSame) {
    return;
  }
  const Status saved = [this] {
    const std::scoped_lock lock(origin_mutex);
    return save_pins();
  }();
  if (!saved) {
    give_up(saved.error());
  }
}

std::string Engine::Impl::scanned_with() {
  const std::scoped_lock lock(origin_mutex);
  if (origin_kept) {
    return told_device(options.device);
  }
  const Result<std::string> own = own_device(*store);
  return own ? told_device(*own) : std::string();
}

std::optional<Rig> Engine::Impl::kept_rig() {
  {
    const std::scoped_lock lock(origin_mutex);
    if (origin_kept) {
      return rig;
    }
  }
  Result<std::optional<Rig>> kept = session_rig(*store);
  if (!kept) {
    emit(Notice{kept.error().line()});
    return std::nullopt;
  }
  return std::move(*kept);
}

Status Engine::Impl::judge_by_kept_rig(EngineResult& result, JobContext& job) {
  const std::optional<Rig> kept = kept_rig();
  const auto told = [](const std::optional<Rig>& one) { return one ? rig_to_json(*one) : std::string(); };
  if (told(kept) == told(rig)) {
    return {};
  }
  const StageClock timing = clock("final planning and meshing");
  Result<RedMap> red_map = planning.red_map(kept ? &*kept : nullptr, job);
  if (!red_map) {
    return std::unexpected(red_map.error());
  }
  result.red_map = std::move(*red_map);
  emit(RedMapChanged{result.red_map, std::nullopt});
  return {};
}

}  // namespace dubsar
