// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar drivers: plugins, devices, what each offers.

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "drivers/loader.h"
#include "station/command/command.h"
#include "station/command/device_wait.h"

namespace dubsar {

namespace {

const char* to_string(SettingType type) {
  switch (type) {
    case SettingType::kBool:
      return "bool";
    case SettingType::kInteger:
      return "integer";
    case SettingType::kNumber:
      return "number";
    case SettingType::kText:
      return "text";
    case SettingType::kChoice:
      break;
  }
  return "choice";
}

nlohmann::ordered_json option_json(const SettingInfo& option) {
  nlohmann::ordered_json json{{"key", option.key}, {"type", to_string(option.type)}, {"help", option.help}};
  if (!option.unit.empty()) {
    json["unit"] = option.unit;
  }
  if (!option.choices.empty()) {
    json["choices"] = option.choices;
  }
  if (option.range) {
    json["range"] = {option.range->first, option.range->second};
  }
  return json;
}

/// " (mm; 0.01 to 5)": what may stand behind the option's "=".
std::string bounds_of(const nlohmann::ordered_json& option) {
  std::string said = option.value("unit", "");
  const auto add = [&](const std::string& more) { said += (said.empty() ? "" : "; ") + more; };
  if (option.contains("choices")) {
    add(fmt::format("{}", fmt::join(option["choices"].get<std::vector<std::string>>(), "|")));
  } else if (option.contains("range")) {
    add(fmt::format("{} to {}", option["range"][0].get<double>(), option["range"][1].get<double>()));
  }
  return said.empty() ? said : " (" + said + ")";
}

Result<int> list_drivers(CommandContext& context) {
  const DevicePatience patience = patience_with_device(context);
  const DriverRegistry registry;
  nlohmann::ordered_json drivers = nlohmann::ordered_json::array();
  for (const Driver& driver : registry.drivers()) {
    nlohmann::ordered_json json{{"scheme", driver.scheme()},
                                {"version", driver.version()},
                                {"description", driver.description()},
                                {"locator", driver.locator_help()},
                                {"path", driver.path().string()}};
    json["options"] = nlohmann::ordered_json::array();
    if (const auto options = driver.options()) {
      for (const SettingInfo& option : *options) {
        json["options"].push_back(option_json(option));
      }
    }
    json["devices"] = nlohmann::ordered_json::array();
    if (const auto devices = driver.discover()) {
      for (const FoundDevice& device : *devices) {
        json["devices"].push_back({{"uri", device.uri}, {"description", device.description}});
      }
    } else {
      json["error"] = devices.error().line();
    }
    drivers.push_back(std::move(json));
  }
  nlohmann::ordered_json rejected = nlohmann::ordered_json::array();
  for (const Error& error : registry.rejected()) {
    rejected.push_back(error.line());
  }

  if (context.json) {
    CommandContext::print({{"drivers", drivers}, {"rejected", rejected}});
    return 0;
  }
  for (const auto& driver : drivers) {
    std::printf("%s:%s  %s\n", driver["scheme"].get<std::string>().c_str(),
                driver["locator"].get<std::string>().c_str(),
                driver["description"].get<std::string>().c_str());
    for (const auto& option : driver["options"]) {
      std::printf("    ?%s=  %s%s\n", option["key"].get<std::string>().c_str(),
                  option["help"].get<std::string>().c_str(), bounds_of(option).c_str());
    }
    if (driver.contains("error")) {
      std::printf("    devices cannot be looked for: %s\n", driver["error"].get<std::string>().c_str());
    }
    for (const auto& device : driver["devices"]) {
      std::printf("    device %s  %s\n", device["uri"].get<std::string>().c_str(),
                  device["description"].get<std::string>().c_str());
    }
  }
  for (const auto& line : rejected) {
    std::printf("left out: %s\n", line.get<std::string>().c_str());
  }
  if (drivers.empty()) {
    return fail(ErrorKind::kDevice, "no driver was found", {}, "reinstall, or set DUBSAR_DRIVER_PATH");
  }
  return 0;
}

}  // namespace

void add_drivers(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand("drivers", "Plugins, devices, and what each offers");
  verb->fallthrough();
  verb->callback([&chosen] { chosen = list_drivers; });
}

}  // namespace dubsar
