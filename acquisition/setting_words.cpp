// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/setting_words.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

namespace dubsar {

namespace {

template <class Number>
std::optional<Number> number_of(const std::string& word) {
  Number value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() ? std::optional(value) : std::nullopt;
}

}  // namespace

Result<SettingValue> setting_value(const SettingInfo& setting, const std::string& word,
                                   const std::string& where) {
  switch (setting.type) {
    case SettingType::kBool:
      if (word == "true" || word == "false" || word == "1" || word == "0") {
        return SettingValue(word == "true" || word == "1");
      }
      break;
    case SettingType::kInteger:
      if (const auto value = number_of<std::int64_t>(word)) {
        return SettingValue(*value);
      }
      break;
    case SettingType::kNumber:
      if (const auto value = number_of<double>(word)) {
        return SettingValue(*value);
      }
      break;
    case SettingType::kText:
    case SettingType::kChoice:
      return SettingValue(word);
  }
  return fail(ErrorKind::kUsage, "setting " + setting.key + " cannot be '" + word + "'", where,
              "it takes " + taken_by(setting));
}

std::string setting_word(const SettingValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) {
    return *flag ? "true" : "false";
  }
  if (const auto* text = std::get_if<std::string>(&value)) {
    return *text;
  }
  std::array<char, 64> digits{};
  const auto written = std::visit(
      [&](const auto& number) {
        if constexpr (requires { std::to_chars(digits.data(), digits.data() + digits.size(), number); }) {
          return std::to_chars(digits.data(), digits.data() + digits.size(), number);
        } else {
          return std::to_chars_result{digits.data(), std::errc()};
        }
      },
      value);
  return {digits.data(), written.ptr};
}

Status put_settings(Device& device, const std::vector<std::pair<std::string, std::string>>& words,
                    const std::string& where) {
  if (words.empty()) {
    return {};
  }
  const Result<std::vector<SettingInfo>> settings = device.settings();
  if (!settings) {
    return std::unexpected(settings.error());
  }
  for (const auto& [key, word] : words) {
    const auto found = std::ranges::find(*settings, key, &SettingInfo::key);
    if (found == settings->end()) {
      std::string keys;
      for (const SettingInfo& setting : *settings) {
        keys += (keys.empty() ? "it has " : ", ") + setting.key;
      }
      return fail(ErrorKind::kUsage, "the device has no setting " + key, where,
                  keys.empty() ? "it has none" : keys);
    }
    const Result<SettingValue> value = setting_value(*found, word, where);
    if (!value) {
      return std::unexpected(value.error());
    }
    if (Status status = device.set(key, *value); !status) {
      return status;
    }
  }
  return {};
}

}  // namespace dubsar
