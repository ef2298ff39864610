// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// gige_peer SERIAL FOLDER [WORDS]: a range camera on the loopback, served by Aravis's own fake camera over
// real GigE Vision packets with our GenICam description. To be run in a network namespace of its own, as the
// tests do. WORDS: truncated (its description breaks off), lies (it announces less than it sends),
// MODEL=name. Commands on standard input: write ADDRESS VALUE, double ADDRESS VALUE, read ADDRESS, lose
// RATIO, counts.
#include <arv.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <mutex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/drivers/peers/device_thread.h"
#include "tests/drivers/peers/gige_xml.h"

namespace {

using namespace dubsar::test;

std::atomic<std::uint64_t> painted = 0;

void put_double(ArvFakeCamera* camera, guint32 address, double value) {
  guint64 bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  bits = GUINT64_TO_BE(bits);
  arv_fake_camera_write_memory(camera, address, sizeof bits, &bits);
}

/// What the tests expect of each format; column 5 has no return.
void paint(ArvBuffer* buffer, void* /*user*/, guint32 /*exposure*/, guint32 /*gain*/, ArvPixelFormat format) {
  static std::once_flag first;
  std::call_once(first, become_device_thread);  // the camera's only thread
  ++painted;
  std::size_t ignored = 0;
  auto* to = static_cast<std::uint8_t*>(const_cast<void*>(arv_buffer_get_data(buffer, &ignored)));
  const auto width = static_cast<std::uint32_t>(arv_buffer_get_image_width(buffer));
  const auto height = static_cast<std::uint32_t>(arv_buffer_get_image_height(buffer));
  const auto id = static_cast<std::uint32_t>(arv_buffer_get_frame_id(buffer));
  const auto sixteen = [&](std::size_t k, std::uint32_t value) {
    to[2 * k] = static_cast<std::uint8_t>(value);
    to[2 * k + 1] = static_cast<std::uint8_t>(value >> 8U);
  };
  if (static_cast<std::uint32_t>(format) == 0x01080001) {  // by heart, for its frames come fast
    static std::vector<std::uint8_t> picture;
    if (picture.size() != std::size_t{width} * height) {
      picture.resize(std::size_t{width} * height);
      for (std::uint32_t row = 0; row < height; ++row) {
        for (std::uint32_t col = 0; col < width; ++col) {
          picture[std::size_t{row} * width + col] = static_cast<std::uint8_t>(7 * col + 3 * row);
        }
      }
    }
    std::memcpy(to, picture.data(), picture.size());
    std::memcpy(to, &id, sizeof id);
    return;
  }
  const auto real = [&](std::size_t k, float value) { std::memcpy(to + 4 * k, &value, 4); };
  for (std::uint32_t row = 0; row < height; ++row) {
    for (std::uint32_t col = 0; col < width; ++col) {
      const std::size_t k = std::size_t{row} * width + col;
      const bool none = col == 5;
      switch (static_cast<std::uint32_t>(format)) {
        case 0x011000B8:
          sixteen(k, none ? 0 : 1000 + 3 * col + row);
          break;
        case 0x022000BB:
          sixteen(2 * k, 2 * col);
          sixteen(2 * k + 1, none ? 0 : 1000 + 3 * col + row);
          break;
        case 0x012000BF:
          real(k, none ? std::numeric_limits<float>::quiet_NaN() : 0.25F * static_cast<float>(col));
          break;
        case 0x026000C0:
          real(3 * k, 0.5F * static_cast<float>(col));
          real(3 * k + 1, static_cast<float>(row));
          real(3 * k + 2, none ? std::numeric_limits<float>::infinity() : 0.25F * static_cast<float>(col));
          break;
        case 0x01100007:
          sixteen(k, 300 * col + row);
          break;
        default:
          break;
      }
    }
  }
}

std::string command(ArvGvFakeCamera* server, ArvFakeCamera* camera, const std::string& line) {
  std::istringstream words(line);
  std::string what;
  words >> what;
  if (what == "lose") {
    double ratio = 0;
    words >> ratio;
    g_object_set(server, "gvsp-lost-ratio", ratio, nullptr);
    return "ok";
  }
  if (what == "counts") {
    return std::to_string(painted) + " 0 0";
  }
  guint32 address = 0;
  words >> std::hex >> address >> std::dec;
  if (what == "read") {
    guint32 value = 0;
    arv_fake_camera_read_register(camera, address, &value);
    return std::to_string(value);
  }
  if (what == "write") {
    guint32 value = 0;
    words >> value;
    arv_fake_camera_write_register(camera, address, value);
    return "ok";
  }
  if (what == "double") {
    double value = 0;
    words >> value;
    put_double(camera, address, value);
    return "ok";
  }
  return "what?";
}

}  // namespace

int main(int count, char** words) {
  if (count < 3) {
    std::puts("cannot: gige_peer SERIAL FOLDER [WORDS]");
    return 2;
  }
  std::string model = "Range 1";
  std::string xml = range_camera_xml();
  bool lies = false;
  for (int k = 3; k < count; ++k) {
    const std::string word = words[k];
    if (word == "truncated") {
      xml.resize(xml.size() / 3);
    } else if (word.starts_with("MODEL=")) {
      model = word.substr(6);
    }
    lies = lies || word == "lies";
  }
  const std::string path = std::string(words[2]) + "/camera.xml";
  std::ofstream(path) << xml;
  ArvGvFakeCamera* server = arv_gv_fake_camera_new_full("127.0.0.1", words[1], path.c_str());
  if (!arv_gv_fake_camera_is_running(server)) {
    std::puts("cannot: no GigE Vision on the loopback here");
    return 2;
  }
  ArvFakeCamera* camera = arv_gv_fake_camera_get_fake_camera(server);
  char field[32] = "Dubsar";
  arv_fake_camera_write_memory(camera, 0x48, sizeof field, field);
  std::memset(field, 0, sizeof field);
  std::strncpy(field, model.c_str(), sizeof field - 1);
  arv_fake_camera_write_memory(camera, 0x68, sizeof field, field);
  for (const auto& [address, value] :
       {std::pair(0x11cU, 4096U), std::pair(0x118U, 4096U), std::pair(0x100U, 320U), std::pair(0x104U, 40U),
        std::pair(0x128U, 0x011000B8U), std::pair(0x138U, 8000U), std::pair(0x12cU, 1U),
        std::pair(unsigned{kInvalidFlag}, 1U), std::pair(unsigned{kPayloadLie}, lies ? 100000U : 0U)}) {
    arv_fake_camera_write_register(camera, address, value);
  }
  put_double(camera, kScales, 0.05);
  put_double(camera, kScales + 8, 0.1);
  put_double(camera, kScales + 16, 0.01);
  put_double(camera, kOffsets, -8);
  put_double(camera, kOffsets + 8, 0);
  put_double(camera, kOffsets + 16, -5);
  put_double(camera, kInvalidValue, 0);
  arv_fake_camera_set_fill_pattern(camera, paint, nullptr);
  std::puts("ready");
  std::fflush(stdout);
  for (std::string line; std::getline(std::cin, line);) {
    std::cout << command(server, camera, line) << std::endl;
  }
  g_object_unref(server);
  return 0;
}
