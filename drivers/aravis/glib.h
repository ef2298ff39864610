// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <arv.h>

#include <string>

#include "core/result.h"

namespace dubsar::aravis {

/// Of what Aravis gives, which may be none.
[[nodiscard]] inline std::string text_of(const char* text) {
  return text == nullptr ? std::string() : std::string(text);
}

/// The error that an Aravis call fills, freed when it goes.
class GErrorHolder {
 public:
  GErrorHolder() = default;
  ~GErrorHolder() { g_clear_error(&error_); }
  GErrorHolder(const GErrorHolder&) = delete;
  GErrorHolder& operator=(const GErrorHolder&) = delete;

  /// For the call; clears what the last one left.
  [[nodiscard]] GError** fill() {
    g_clear_error(&error_);
    return &error_;
  }
  [[nodiscard]] explicit operator bool() const { return error_ != nullptr; }

  /// What happened to the camera `where` while `doing`, with its mend.
  [[nodiscard]] Error told(const std::string& doing, const std::string& where) const {
    const bool of_device = error_ != nullptr && error_->domain == ARV_DEVICE_ERROR;
    switch (of_device ? error_->code : -1) {
      case ARV_DEVICE_ERROR_NOT_FOUND:
        return {ErrorKind::kDevice, "the camera is not there", where,
                "see to its cable and address; dubsar drivers lists those that are; a USB camera needs "
                "60-dubsar.rules in /etc/udev/rules.d"};
      case ARV_DEVICE_ERROR_NOT_CONTROLLER:
        return {ErrorKind::kDevice, "the camera is in use by another program", where,
                "close what shows its picture, then try again"};
      case ARV_DEVICE_ERROR_GENICAM_NOT_FOUND:
        return {ErrorKind::kBadInput, "the camera's description (GenICam) cannot be read", where,
                "update its firmware with its maker's program"};
      case ARV_DEVICE_ERROR_TIMEOUT:
      case ARV_DEVICE_ERROR_NOT_CONNECTED:
      case ARV_DEVICE_ERROR_TRANSFER_ERROR:
        return {ErrorKind::kDevice, "the camera does not answer", where, "see to its cable and power"};
      default:
        break;
    }
    const std::string why = error_ == nullptr ? "no reason given" : std::string(error_->message);
    // These alone may be about a value that was asked for; the others mean a description that does not hold
    // together.
    const bool of_description =
        error_ != nullptr && error_->domain == ARV_GC_ERROR && error_->code != ARV_GC_ERROR_OUT_OF_RANGE &&
        error_->code != ARV_GC_ERROR_READ_ONLY && error_->code != ARV_GC_ERROR_ENUM_ENTRY_NOT_FOUND;
    if (of_description) {
      return {ErrorKind::kBadInput, doing + ", for its description (GenICam) is broken: " + why, where,
              "update its firmware with its maker's program"};
    }
    return {ErrorKind::kDevice, doing + ": " + why, where, "see that nothing else uses it"};
  }

 private:
  GError* error_ = nullptr;
};

/// A text of the camera, by read(GError**). Where there was an error it is empty: what Aravis (0.8.26) gives
/// then may be the memory that the text was to be read into, without an end.
template <class Read>
[[nodiscard]] std::string text_read(GErrorHolder& error, const Read& read) {
  const char* text = read(error.fill());
  return error ? std::string() : text_of(text);
}

}  // namespace dubsar::aravis
