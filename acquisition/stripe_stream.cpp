// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/stripe_stream.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/thread_priority.h"

namespace dubsar {

namespace {

constexpr auto kFrameWait = std::chrono::milliseconds(100);
constexpr auto kLongestGap = std::chrono::seconds(3);

}  // namespace

StripeStream::StripeStream(Device& camera, const StripeOptions& options,
                           std::function<Status(const Frame&)> check)
    : camera_(camera), options_(options), check_(std::move(check)) {
  const unsigned workers = std::clamp(std::thread::hardware_concurrency(), 1U, 4U);
  for (unsigned k = 0; k < workers; ++k) {
    finders_.emplace_back([this](const std::stop_token& enough) { find(enough); });
  }
  taker_ = std::jthread([this](const std::stop_token& enough) { take(enough); });
}

StripeStream::~StripeStream() {
  taker_.request_stop();
  for (std::jthread& one : finders_) {
    one.request_stop();
  }
  taker_.join();
  finders_.clear();
  waiting_.clear();
}

void StripeStream::take(const std::stop_token& enough) {
  prefer_this_thread();
  auto last = std::chrono::steady_clock::now();
  while (!enough.stop_requested()) {
    Result<std::optional<Frame>> frame = camera_.next_frame(kFrameWait);
    std::optional<Error> error;
    if (!frame) {
      error = frame.error();
    } else if (*frame && !(*frame)->incomplete) {
      last = std::chrono::steady_clock::now();
      const Status fine = check_(**frame);
      if (fine) {
        const std::lock_guard lock(mutex_);
        waiting_.push_back({taken_++, std::move(**frame)});
      } else {
        error = fine.error();
      }
    } else if (std::chrono::steady_clock::now() - last > kLongestGap) {
      error = fail(ErrorKind::kDevice, "no frame came from the camera in 3 s", camera_.uri(),
                   "see that its trigger is free, and the cable")
                  .error();
    }
    if (error) {
      const std::lock_guard lock(mutex_);
      error_ = std::move(error);
    }
    frames_.notify_one();
    if (error_) {
      stripes_.notify_all();
      return;
    }
  }
}

void StripeStream::find(const std::stop_token& enough) {
  StripeExtractor extractor(options_);
  for (;;) {
    Waiting one;
    {
      std::unique_lock lock(mutex_);
      if (!frames_.wait(lock, enough, [&] { return !waiting_.empty(); })) {
        return;
      }
      one = std::move(waiting_.front());
      waiting_.pop_front();
    }
    StreamedStripe out;
    out.id = one.frame.id;
    out.timestamp_ns = one.frame.timestamp_ns;
    extractor.extract({one.frame.pixels.data(), static_cast<int>(one.frame.width),
                       static_cast<int>(one.frame.height), one.frame.stride_bytes},
                      GrayView{}, out.stripe);
    const std::int64_t number = one.number;
    one.frame = Frame{};  // back to the camera
    {
      const std::lock_guard lock(mutex_);
      found_.emplace(number, std::move(out));
    }
    stripes_.notify_all();
  }
}

Result<StreamedStripe> StripeStream::next() {
  std::unique_lock lock(mutex_);
  // What was seen before a failure is given first.
  stripes_.wait(lock, [&] { return found_.contains(given_) || (error_ && given_ == taken_); });
  const auto next = found_.find(given_);
  if (next == found_.end()) {
    return std::unexpected(*error_);
  }
  StreamedStripe out = std::move(next->second);
  found_.erase(next);
  ++given_;
  return out;
}

}  // namespace dubsar
