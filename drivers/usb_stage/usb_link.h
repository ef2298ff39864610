// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "drivers/usb_stage/link.h"

struct libusb_context;
struct libusb_device_handle;

namespace dubsar::usb_stage {

/// Which controller: by maker and product, and of several by its serial number.
struct UsbName {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::string serial;  ///< empty: any

  /// "2341:0043" or "2341:0043:SERIAL".
  [[nodiscard]] static std::optional<UsbName> parse(std::string_view text);
  [[nodiscard]] std::string text() const;
};

struct FoundController {
  UsbName name;
  std::string product;
};

/// A serial line over USB (CDC-ACM), at 115200 baud, 8N1, straight through libusb.
class UsbLink : public Link {
 public:
  /// kDevice: not there, no right to it (names the udev rule), in use, or no such line.
  [[nodiscard]] static Result<std::unique_ptr<UsbLink>> open(const UsbName& name);
  ~UsbLink() override;
  UsbLink(const UsbLink&) = delete;
  UsbLink& operator=(const UsbLink&) = delete;

  Status write(std::string_view bytes) override;
  Result<std::string> read(std::chrono::milliseconds timeout) override;

  [[nodiscard]] const std::string& serial() const { return serial_; }
  [[nodiscard]] const std::string& product() const { return product_; }

 private:
  UsbLink() = default;
  Status claim();

  UsbName name_;
  std::string serial_, product_;
  libusb_context* context_ = nullptr;
  libusb_device_handle* handle_ = nullptr;
  int control_interface_ = -1;
  int data_interface_ = -1;
  std::uint8_t in_ = 0;
  std::uint8_t out_ = 0;
};

/// All serial lines over USB that are plugged in.
[[nodiscard]] std::vector<FoundController> find_controllers();

/// The error that libusb's number means, with the mend it asks for.
[[nodiscard]] Error usb_error(int number, const std::string& doing, const std::string& where);

}  // namespace dubsar::usb_stage
