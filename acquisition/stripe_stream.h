// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "acquisition/stripe.h"
#include "core/result.h"
#include "drivers/device.h"

namespace dubsar {

/// The stripe of one frame of a stream.
struct StreamedStripe {
  std::int64_t id = 0;  ///< of the frame; a gap is frames that were lost
  std::int64_t timestamp_ns = 0;
  StripeProfile stripe;
};

/// Stripes at the rate of the camera: one thread takes frames and does nothing else, some find the stripes,
/// and whoever asks gets them in the order of the frames. What it gives is the same for any number of
/// threads.
class StripeStream {
 public:
  /// `check` says what is wrong with a frame; the stream ends there. The camera streams already and is used
  /// by nobody else while this lives.
  StripeStream(Device& camera, const StripeOptions& options, std::function<Status(const Frame&)> check);
  ~StripeStream();
  StripeStream(const StripeStream&) = delete;
  StripeStream& operator=(const StripeStream&) = delete;

  /// Waits for the next one. kDevice: no frame came in 3 s, or the camera is gone.
  [[nodiscard]] Result<StreamedStripe> next();

 private:
  struct Waiting {
    std::int64_t number;
    Frame frame;
  };
  void take(const std::stop_token& enough);
  void find(const std::stop_token& enough);

  Device& camera_;
  StripeOptions options_;
  std::function<Status(const Frame&)> check_;
  std::mutex mutex_;
  std::condition_variable_any frames_, stripes_;
  std::deque<Waiting> waiting_;
  std::map<std::int64_t, StreamedStripe> found_;
  std::int64_t taken_ = 0;  ///< frames
  std::int64_t given_ = 0;  ///< stripes
  std::optional<Error> error_;
  std::vector<std::jthread> finders_;
  std::jthread taker_;
};

}  // namespace dubsar
