// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "core/utf8.h"

namespace dubsar {

namespace {

spdlog::logger& logger() {
  static const std::shared_ptr<spdlog::logger> kLogger = [] {
    auto made =
        std::make_shared<spdlog::logger>("dubsar", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
    made->set_pattern("%^%l%$: %v");
    made->set_level(spdlog::level::info);
    return made;
  }();
  return *kLogger;
}

}  // namespace

void set_log_level(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      logger().set_level(spdlog::level::debug);
      break;
    case LogLevel::kInfo:
      logger().set_level(spdlog::level::info);
      break;
    case LogLevel::kWarning:
      logger().set_level(spdlog::level::warn);
      break;
    case LogLevel::kError:
      logger().set_level(spdlog::level::err);
      break;
  }
}

void log_debug(const std::string& text) {
  logger().debug(one_line(text));
}
void log_info(const std::string& text) {
  logger().info(one_line(text));
}
void log_warning(const std::string& text) {
  logger().warn(one_line(text));
}
void log_error(const std::string& text) {
  logger().error(one_line(text));
}

}  // namespace dubsar
