// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/usb_stage/lines.h"
#include "drivers/usb_stage/link.h"

namespace dubsar::usb_stage {

/// Lines over a link.
class LineTalk {
 public:
  LineTalk(Link& link, std::string where) : link_(link), where_(std::move(where)) {}

  Status write(std::string_view bytes) { return link_.write(bytes); }
  Status send(const std::string& line) { return link_.write(line + "\n"); }

  /// The next line; nothing when none came before `until`.
  Result<std::optional<std::string>> line(Clock::time_point until) {
    for (;;) {
      if (std::optional<std::string> one = lines_.next()) {
        return one;
      }
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
      if (left.count() <= 0) {
        return std::nullopt;
      }
      Result<std::string> bytes = link_.read(left);
      if (!bytes) {
        return std::unexpected(bytes.error());
      }
      lines_.add(*bytes);
    }
  }

  /// Lines until `take` says that it has what it wants. kDevice when it did not get it before `until`.
  template <class Take>
  Status until(Clock::time_point until, const Take& take) {
    for (;;) {
      Result<std::optional<std::string>> one = line(until);
      if (!one) {
        return std::unexpected(one.error());
      }
      if (!*one) {
        return silent();
      }
      if (take(**one)) {
        return {};
      }
    }
  }

  /// Asks with one character that changes nothing, again where no answer comes, until `take` has what it
  /// wants.
  template <class Take>
  Status ask(char question, const Take& take) {
    const Clock::time_point until = Clock::now() + kAnswer;
    while (Clock::now() < until) {
      if (const Status sent = write(std::string_view(&question, 1)); !sent) {
        return sent;
      }
      const Clock::time_point again = std::min(Clock::now() + kAskAgain, until);
      for (;;) {
        Result<std::optional<std::string>> one = line(again);
        if (!one) {
          return std::unexpected(one.error());
        }
        if (!*one) {
          break;
        }
        if (take(**one)) {
          return {};
        }
      }
    }
    return silent();
  }

  [[nodiscard]] std::unexpected<Error> silent() const {
    return fail(ErrorKind::kDevice, "the controller does not answer", where_,
                "see to its power and cable, and that its laser is off");
  }
  [[nodiscard]] const std::string& where() const { return where_; }
  void forget() { lines_.clear(); }

 private:
  Link& link_;
  std::string where_;
  LineSplitter lines_;
};

}  // namespace dubsar::usb_stage
