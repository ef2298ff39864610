// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <optional>

namespace dubsar::v4l2 {

/// Numbers the frames of a stream from 1 on and tells how many are missing: by the camera's own numbers, and
/// where these have no gap (some cameras number no frames) by how often the kernel said that one went wrong
/// on the way.
class FrameNumbers {
 public:
  struct Step {
    std::uint64_t id = 0;
    std::uint64_t lost = 0;  ///< frames that did not come before this one
  };

  /// One went wrong. It counts when the next one comes: a stream that is broken says so without end.
  void went_wrong() { ++wrong_; }

  /// `sequence`: the camera's number of a frame that came. A step back or none is taken for the next frame.
  Step take(std::uint32_t sequence) {
    const std::uint32_t step = last_ ? sequence - *last_ : 1U;
    const std::uint64_t missing = step >= 1 && step < 1U << 31U ? step - 1 : 0;
    last_ = sequence;
    id_ += missing + 1;
    const Step out{id_, missing > 0 ? missing : wrong_};
    wrong_ = 0;
    return out;
  }

 private:
  std::optional<std::uint32_t> last_;
  std::uint64_t id_ = 0;
  std::uint64_t wrong_ = 0;
};

}  // namespace dubsar::v4l2
