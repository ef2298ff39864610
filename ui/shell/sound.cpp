// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/sound.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string>
#include <system_error>
#include <thread>

namespace dubsar::ui {

namespace {

constexpr int kRateHz = 22050;
constexpr double kNoteS = 0.14;

void put(std::vector<std::uint8_t>& out, std::uint32_t value, int bytes) {
  for (int k = 0; k < bytes; ++k) {
    out.push_back(static_cast<std::uint8_t>(value >> (8 * k)));
  }
}

void put(std::vector<std::uint8_t>& out, const char* four) {
  for (int k = 0; k < 4; ++k) {
    out.push_back(static_cast<std::uint8_t>(four[k]));
  }
}

/// Plays a file and takes it away again. On a thread of its own.
void play_file(const std::string& file) {
  for (const char* player : {"pw-play", "paplay", "aplay"}) {
    std::string name = player;
    std::string path = file;
    std::array<char*, 3> argv{name.data(), path.data(), nullptr};
    posix_spawn_file_actions_t quiet;
    posix_spawn_file_actions_init(&quiet);
    posix_spawn_file_actions_addopen(&quiet, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&quiet, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t pid = -1;
    const int failed = posix_spawnp(&pid, player, &quiet, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&quiet);
    int status = 1;
    if (failed == 0 && waitpid(pid, &status, 0) == pid && WIFEXITED(status) && WEXITSTATUS(status) == 0) {
      unlink(file.c_str());
      return;
    }
  }
  unlink(file.c_str());
  std::fputc('\a', stderr);
}

}  // namespace

std::vector<std::uint8_t> tone_of(Sound sound) {
  const std::array<double, 2> notes =
      sound == Sound::kDone ? std::array{659.3, 880.0} : std::array{330.0, 220.0};
  const auto per_note = static_cast<std::uint32_t>(kNoteS * kRateHz);
  const std::uint32_t bytes = 2 * 2 * per_note;
  std::vector<std::uint8_t> out;
  put(out, "RIFF");
  put(out, 36 + bytes, 4);
  put(out, "WAVE");
  put(out, "fmt ");
  put(out, 16, 4);
  put(out, 1, 2);  // PCM
  put(out, 1, 2);  // one channel
  put(out, kRateHz, 4);
  put(out, 2 * kRateHz, 4);
  put(out, 2, 2);
  put(out, 16, 2);
  put(out, "data");
  put(out, bytes, 4);
  for (const double note : notes) {
    for (std::uint32_t k = 0; k < per_note; ++k) {
      const double part = static_cast<double>(k) / per_note;
      const double swell = std::sin(std::numbers::pi * part);  // begins and ends without a click
      const double wave = std::sin(2 * std::numbers::pi * note * k / kRateHz);
      put(out, static_cast<std::uint16_t>(static_cast<std::int16_t>(9000 * swell * wave)), 2);
    }
  }
  return out;
}

void play(Sound sound) {
  std::error_code nowhere;  // TMPDIR may be gone: no tone is worth the window
  std::string file = (std::filesystem::temp_directory_path(nowhere) / "dubsar-XXXXXX").string();
  const int open_file = nowhere ? -1 : mkstemp(file.data());
  if (open_file < 0) {
    return;
  }
  const std::vector<std::uint8_t> tone = tone_of(sound);
  const bool whole = write(open_file, tone.data(), tone.size()) == static_cast<ssize_t>(tone.size());
  close(open_file);
  if (!whole) {
    unlink(file.c_str());
    return;
  }
  try {
    std::thread([file] { play_file(file); }).detach();
  } catch (const std::system_error&) {  // nor is a thread that the system does not start
    unlink(file.c_str());
  }
}

}  // namespace dubsar::ui
