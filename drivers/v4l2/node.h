// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"
#include "drivers/v4l2/modes.h"

namespace dubsar::v4l2 {

/// An open camera file. Calls go to the kernel itself, or, behind convert(), through libv4l2. Does not insist
/// on a character device. Never blocks: the file is opened so.
class Node {
 public:
  /// kDevice: not there, no right to it (names the udev rule), in use, or no camera.
  [[nodiscard]] static Result<Node> open(const std::string& path);
  Node(Node&& other) noexcept;
  Node& operator=(Node&&) = delete;
  ~Node();

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::string& card() const { return card_; }  ///< maker and model, as the camera says
  [[nodiscard]] const std::string& bus() const { return bus_; }    ///< where it is plugged in
  [[nodiscard]] int fd() const { return fd_; }

  /// As ::ioctl, repeated where a signal came between; errno is set.
  int control(unsigned long request, void* argument) const;
  [[nodiscard]] void* map(std::size_t length, std::int64_t offset) const;
  void unmap(void* at, std::size_t length) const;

  /// From now on through libv4l2, which converts what it must. kDevice when it cannot.
  Status convert();
  [[nodiscard]] bool converts() const { return converts_; }

  /// Whether the camera still answers.
  [[nodiscard]] bool alive() const;

  /// What the camera can send.
  [[nodiscard]] std::vector<Mode> modes() const;
  /// Of frames of this size; 0 where it does not say.
  [[nodiscard]] double fastest_hz(std::uint32_t fourcc, std::uint32_t width, std::uint32_t height) const;

 private:
  Node(std::string path, int fd) : path_(std::move(path)), fd_(fd) {}
  std::string path_, card_, bus_;
  int fd_ = -1;
  bool converts_ = false;
};

/// Whether an errno means that the device is no longer there.
[[nodiscard]] bool means_gone(int number);

/// The error of a failed call, with the mend that its errno asks for.
[[nodiscard]] Error error_of(int number, const std::string& doing, const std::string& path);

}  // namespace dubsar::v4l2
