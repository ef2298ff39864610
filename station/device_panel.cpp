// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/device_panel.h"

#include <algorithm>

#include "acquisition/device_uri.h"
#include "acquisition/setting_words.h"
#include "formats/json_node.h"
#include "formats/json_text.h"

namespace dubsar {

namespace {

constexpr const char* kDocument = "device_settings";

/// In the order in which a session was opened with them, the last one last.
using ByDevice = std::vector<std::pair<std::string, SettingWords>>;

Result<ByDevice> load(const SessionStore& store) {
  const auto text = store.load_document(kDocument);
  if (!text) {
    return std::unexpected(text.error());
  }
  ByDevice out;
  if (!*text) {
    return out;
  }
  const std::string where = (store.folder() / "session.sqlite").string() + " (" + kDocument + ")";
  const Result<JsonDocument> document = JsonDocument::parse(**text, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  for (const JsonNode& device : root.at("devices").items()) {
    auto& [uri, words] = out.emplace_back(device.at("uri").text(), SettingWords{});
    for (const JsonNode& setting : device.at("settings").items()) {
      words.emplace_back(setting.at("key").text(), setting.at("value").text());
    }
  }
  if (Status status = document->status("change the settings again"); !status) {
    return std::unexpected(status.error());
  }
  return out;
}

Status save(SessionStore& store, const ByDevice& all) {
  OrderedJson devices = OrderedJson::array();
  for (const auto& [device, settings] : all) {
    OrderedJson list = OrderedJson::array();
    for (const auto& [key, word] : settings) {
      list.push_back({{"key", key}, {"value", word}});
    }
    devices.push_back({{"uri", device}, {"settings", std::move(list)}});
  }
  OrderedJson root;
  root["devices"] = std::move(devices);
  return store.save_document(kDocument, text_of(root));
}

}  // namespace

Result<DevicePanel> panel_of(Device& device) {
  DevicePanel out;
  out.uri = device.uri();
  const Result<DeviceCapabilities> can = device.capabilities();
  Result<std::vector<SettingInfo>> settings = device.settings();
  if (!can || !settings) {
    return std::unexpected(can ? settings.error() : can.error());
  }
  out.has_camera = can->yields_frames;
  for (SettingInfo& info : *settings) {
    std::string word;
    if (info.readable) {
      const Result<SettingValue> value = device.get(info.key);
      if (!value) {
        return std::unexpected(value.error());
      }
      word = setting_word(*value);
    }
    out.settings.push_back({std::move(info), std::move(word)});
  }
  return out;
}

void put_word(SettingWords& words, const std::string& key, const std::string& word) {
  const auto known = std::ranges::find(words, key, &SettingWords::value_type::first);
  if (known != words.end()) {
    words.erase(known);  // later ones may depend on it: it takes its place at the end
  }
  words.emplace_back(key, word);
}

std::string put_kept(Device& device, const SettingWords& words, const std::string& uri) {
  std::string refused;
  for (const auto& word : words) {
    if (const Status put = put_settings(device, {word}, uri); !put) {
      refused += (refused.empty() ? "" : "; ") + put.error().line();
    }
  }
  return refused;
}

Result<SettingWords> kept_settings(const SessionStore& store, const std::string& uri) {
  Result<ByDevice> all = load(store);
  if (!all) {
    return std::unexpected(all.error());
  }
  const auto known = std::ranges::find(*all, absolute_device(uri),
                                       [](const auto& one) { return absolute_device(one.first); });
  return known == all->end() ? SettingWords{} : std::move(known->second);
}

Status keep_settings(SessionStore& store, const std::string& uri, const SettingWords& words) {
  Result<ByDevice> all = load(store);
  if (!all) {
    return std::unexpected(all.error());
  }
  const std::string own = absolute_device(uri);
  std::erase_if(*all, [&](const auto& known) { return absolute_device(known.first) == own; });
  all->emplace_back(own, words);  // the last one is the session's own
  return save(store, *all);
}

Status note_settings(SessionStore& store, const std::string& uri, const SettingWords& words) {
  const auto scans = store.scans();
  Result<ByDevice> all = load(store);
  if (!scans || !all) {
    return std::unexpected(scans ? all.error() : scans.error());
  }
  if (scans->empty()) {
    return keep_settings(store, uri, words);
  }
  const std::string own = absolute_device(uri);
  const auto known = std::ranges::find(*all, own, [](const auto& one) { return absolute_device(one.first); });
  if (known != all->end()) {
    *known = {own, words};
  } else {
    all->emplace(all->begin(), own, words);
  }
  return save(store, *all);
}

Result<std::string> own_device(const SessionStore& store) {
  const Result<ByDevice> all = load(store);
  if (!all) {
    return std::unexpected(all.error());
  }
  return all->empty() ? std::string() : all->back().first;
}

}  // namespace dubsar
