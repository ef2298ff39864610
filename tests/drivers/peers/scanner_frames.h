// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <span>
#include <string>
#include <vector>

namespace dubsar::test {

/// Frames of a scan, each with the position of the stage that it was rendered for, in a file: width, height,
/// count, the positions, a dark frame, the frames.
class ScannerFrames {
 public:
  static bool write(const std::string& path, std::uint32_t width, std::uint32_t height,
                    const std::vector<double>& positions,
                    const std::vector<std::vector<std::uint8_t>>& frames,
                    const std::vector<std::uint8_t>& dark) {
    std::ofstream file(path, std::ios::binary);
    const Head head{width, height, positions.size()};
    const auto put = [&](const void* from, std::size_t size) {
      file.write(static_cast<const char*>(from), static_cast<std::streamsize>(size));
    };
    put(&head, sizeof head);
    put(positions.data(), positions.size() * sizeof(double));
    put(dark.data(), dark.size());
    for (const std::vector<std::uint8_t>& one : frames) {
      put(one.data(), one.size());
    }
    return static_cast<bool>(file);
  }

  explicit ScannerFrames(const std::string& path) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat what {};
    if (file >= 0 && ::fstat(file, &what) == 0 && what.st_size > static_cast<off_t>(sizeof(Head))) {
      size_ = static_cast<std::size_t>(what.st_size);
      void* const at = ::mmap(nullptr, size_, PROT_READ, MAP_SHARED, file, 0);
      bytes_ = at == MAP_FAILED ? nullptr : static_cast<const std::uint8_t*>(at);
    }
    ::close(file);
    if (bytes_ != nullptr) {
      std::memcpy(&head_, bytes_, sizeof head_);
      if (sizeof head_ + head_.count * sizeof(double) + (head_.count + 1) * frame_bytes() != size_) {
        ::munmap(const_cast<std::uint8_t*>(bytes_), size_);
        bytes_ = nullptr;
      }
    }
  }
  ~ScannerFrames() {
    if (bytes_ != nullptr) {
      ::munmap(const_cast<std::uint8_t*>(bytes_), size_);
    }
  }
  ScannerFrames(const ScannerFrames&) = delete;
  ScannerFrames& operator=(const ScannerFrames&) = delete;

  [[nodiscard]] bool works() const { return bytes_ != nullptr; }
  [[nodiscard]] std::uint32_t width() const { return head_.width; }
  [[nodiscard]] std::uint32_t height() const { return head_.height; }
  [[nodiscard]] std::size_t count() const { return head_.count; }
  [[nodiscard]] double position(std::size_t k) const {
    double out = 0;
    std::memcpy(&out, bytes_ + sizeof head_ + k * sizeof out, sizeof out);
    return out;
  }
  [[nodiscard]] std::span<const std::uint8_t> dark() const { return at(0); }
  [[nodiscard]] std::span<const std::uint8_t> frame(std::size_t k) const { return at(k + 1); }

 private:
  struct Head {
    std::uint32_t width, height;
    std::uint64_t count;
  };
  [[nodiscard]] std::size_t frame_bytes() const { return std::size_t{head_.width} * head_.height; }
  [[nodiscard]] std::span<const std::uint8_t> at(std::size_t number) const {
    return {bytes_ + sizeof head_ + head_.count * sizeof(double) + number * frame_bytes(), frame_bytes()};
  }
  Head head_{};
  const std::uint8_t* bytes_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace dubsar::test
