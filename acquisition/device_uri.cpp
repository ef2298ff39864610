// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/device_uri.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "acquisition/rig_device.h"

namespace dubsar {

namespace {

constexpr const char* kMarkInName = "in the name of a folder or file write %3F for ? and %25 for %";

/// A colon that ends a scheme, or npos: "C:/x" with its single letter, "./a:b" and "/a:b" are paths.
std::size_t scheme_end(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos || colon < 2 || text[0] < 'a' || text[0] > 'z') {
    return std::string_view::npos;
  }
  const bool plain = std::ranges::all_of(text.substr(0, colon), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
  return plain ? colon : std::string_view::npos;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') {
    return c - '0';
  }
  const char lower = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

Result<std::string> decoded(std::string_view text, std::string_view whole) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
    const int low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
    if (high < 0 || low < 0 || (high == 0 && low == 0)) {
      return fail(ErrorKind::kUsage, "'%' without two hexadecimal digits", std::string(whole),
                  "write %25 for the sign itself");
    }
    out += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return out;
}

std::string encoded(std::string_view text) {
  constexpr char kHex[] = "0123456789ABCDEF";
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte <= 0x20 || byte == 0x7f || c == '%' || c == '?' || c == '&' || c == '=' || c == '#') {
      out += '%';
      out += kHex[byte >> 4U];
      out += kHex[byte & 15U];
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace

std::string DeviceUri::text() const {
  std::string out = scheme + ":" + encoded(locator);
  char mark = '?';
  for (const auto& [key, value] : options) {
    out += mark;
    out += encoded(key) + "=" + encoded(value);
    mark = '&';
  }
  return out;
}

Result<DeviceUri> parse_device_uri(std::string_view text) {
  if (text.empty()) {
    return fail(ErrorKind::kUsage, "no device named", {}, "name one, such as sim: or replay:FOLDER");
  }
  if (text.find('\0') != std::string_view::npos) {
    return fail(ErrorKind::kUsage, "a zero byte in the name of a device",
                std::string(text.substr(0, text.find('\0'))), "take it out");
  }
  const std::size_t colon = scheme_end(text);
  if (colon == std::string_view::npos) {
    return DeviceUri{"replay", std::string(text), {}};
  }
  DeviceUri out;
  out.scheme = text.substr(0, colon);
  const std::string_view rest = text.substr(colon + 1);
  const std::size_t mark = rest.find('?');
  Result<std::string> locator = decoded(rest.substr(0, mark), text);
  if (!locator) {
    return std::unexpected(locator.error());
  }
  out.locator = std::move(*locator);
  std::string_view query = mark == std::string_view::npos ? std::string_view() : rest.substr(mark + 1);
  while (!query.empty()) {
    const std::string_view part = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(query.size(), part.size() + 1));
    if (part.empty()) {
      continue;
    }
    const std::size_t equals = part.find('=');
    if (equals == std::string_view::npos || equals == 0) {
      return fail(ErrorKind::kUsage, "option '" + std::string(part) + "' is not key=value", std::string(text),
                  kMarkInName);
    }
    const Result<std::string> key = decoded(part.substr(0, equals), text);
    const Result<std::string> value = decoded(part.substr(equals + 1), text);
    if (!key || !value) {
      return std::unexpected(key ? value.error() : key.error());
    }
    if (std::ranges::find(out.options, *key, [](const auto& option) { return option.first; }) !=
        out.options.end()) {
      return fail(ErrorKind::kUsage, "option " + *key + " is given twice", std::string(text));
    }
    out.options.emplace_back(*key, *value);
  }
  return out;
}

std::string absolute_device(const std::string& uri) {
  Result<DeviceUri> parts = parse_device_uri(uri);
  const bool is_of_files = parts && (parts->scheme == "replay" || parts->scheme == "rig");
  if (!is_of_files || parts->locator.empty() || std::filesystem::path(parts->locator).is_absolute()) {
    return uri;
  }
  std::error_code failed;
  const std::filesystem::path whole = std::filesystem::absolute(parts->locator, failed);
  if (failed) {
    return uri;
  }
  parts->locator = whole.lexically_normal().string();
  return parts->text();
}

Result<Device> open_device(const DeviceUri& uri, const DriverRegistry& registry) {
  if (uri.scheme == "rig") {
    if (!uri.options.empty()) {
      return fail(ErrorKind::kUsage, "a rig has no option " + uri.options.front().first, uri.text(),
                  "say it in the rig's file");
    }
    if (uri.locator.empty()) {
      return fail(ErrorKind::kUsage, "no rig is named", "rig:", "write rig:FILE.toml");
    }
    return open_rig(uri.locator, registry);
  }
  const Result<const Driver*> driver = registry.find(uri.scheme);
  if (!driver) {
    return std::unexpected(driver.error());
  }
  Result<Device> device = (*driver)->open(uri.locator, uri.options);
  if (!device && device.error().kind == ErrorKind::kUsage && uri.scheme == "replay" && !uri.options.empty() &&
      device.error().what.starts_with("no option")) {
    device.error().mend += std::string("; ") + kMarkInName;
  }
  return device;
}

}  // namespace dubsar
