// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The window's settings, which people edit by hand: whatever they become, they are written as they were read.
#include <filesystem>
#include <fstream>

#include "fuzz/fuzz_support.h"
#include "ui/shell/theme.h"

namespace fs = std::filesystem;
using namespace dubsar;

namespace {

struct Folder {
  fs::path path = fuzz::work_path();
  Folder() {
    fs::remove_all(path);
    fs::create_directories(path);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  const fs::path file = folder.path / "window.conf";
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  const ui::Preferences read = ui::read_preferences(file);
  fuzz::require(read.font_px >= ui::kSmallestFontPx && read.font_px <= ui::kLargestFontPx);
  ui::write_preferences(file, read);
  ui::Preferences again = ui::read_preferences(file);
  fuzz::require(std::abs(again.font_px - read.font_px) < 0.001F);  // written in six digits
  again.font_px = read.font_px;
  fuzz::require(again == read);
  return 0;
}
