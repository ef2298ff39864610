// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/command/device_wait.h"

#include <unistd.h>

#include <atomic>
#include <memory>
#include <string>
#include <string_view>

#include "core/log.h"
#include "station/command/terminal.h"

namespace dubsar {

namespace {

/// What is said at the end, ready for a signal handler.
struct LastWords {
  std::string err;
  std::string out;
  int status = 0;
};
std::atomic<const LastWords*> g_last_words{nullptr};

/// Whoever waits for the device has them said, and nobody else.
struct LastWordsGo {
  LastWordsGo() = default;
  ~LastWordsGo() { g_last_words = nullptr; }
  LastWordsGo(const LastWordsGo&) = delete;
  LastWordsGo& operator=(const LastWordsGo&) = delete;
};

LastWords last_words(const Error& error, bool json) {
  const auto line = [&] {
    return error_json(error).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  };
  return {"dubsar: " + error.line() + "\n", json ? line() : std::string(), exit_status(error.kind)};
}

/// Past the streams of the C library: whoever hangs may hold them.
void write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(file, text.data(), text.size());
    if (written <= 0) {
      return;
    }
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

[[noreturn]] void say_and_end(const LastWords& words) {
  write_all(STDERR_FILENO, words.err);
  write_all(STDOUT_FILENO, words.out);
  ::_exit(words.status);
}

}  // namespace

void end_without_device(const Error& error, bool json) {
  static std::atomic_flag ends;
  while (ends.test_and_set()) {
    ::pause();  // another thread has begun to
  }
  say_and_end(last_words(error, json));
}

void end_if_told() {
  if (const LastWords* words = g_last_words) {
    say_and_end(*words);
  }
}

DevicePatience patience_with_device(const CommandContext& context) {
  return {[&job = context.job] { return job.cancelled(); },
          [json = context.json, go = std::make_shared<LastWordsGo>()](const Error& error) {
            finish_progress();
            log_warning(error.line());
            Error last = error;
            last.mend = "what was stored is safe, and the same command goes on with it";
            g_last_words = new LastWords(last_words(last, json));  // a signal may just be reading them
          },
          [json = context.json](const Error& error) { end_without_device(error, json); },
          [] { g_last_words = nullptr; }};
}

}  // namespace dubsar
