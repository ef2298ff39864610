// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/usb_stage/usb_link.h"

#include <libusb.h>

#include <array>
#include <charconv>
#include <cstdio>
#include <thread>

namespace dubsar::usb_stage {

namespace {

constexpr unsigned kTransferMs = 500;
constexpr std::chrono::milliseconds kBusyFor(1000);
// USB class definitions for communication devices, PSTN subclass.
constexpr std::uint8_t kToInterface = 0x21;
constexpr std::uint8_t kSetLineCoding = 0x20;
constexpr std::uint8_t kSetControlLines = 0x22;
constexpr std::uint16_t kReady = 3;  // DTR and RTS

struct Interfaces {
  int control = -1;
  int data = -1;
  std::uint8_t in = 0;
  std::uint8_t out = 0;

  [[nodiscard]] bool whole() const { return data >= 0 && in != 0 && out != 0; }
};

Interfaces interfaces_of(libusb_device* device) {
  Interfaces out;
  libusb_config_descriptor* config = nullptr;
  if (libusb_get_active_config_descriptor(device, &config) != 0 &&
      libusb_get_config_descriptor(device, 0, &config) != 0) {
    return out;
  }
  for (int k = 0; k < config->bNumInterfaces; ++k) {
    if (config->interface[k].num_altsetting < 1) {
      continue;
    }
    const libusb_interface_descriptor& one = config->interface[k].altsetting[0];
    if (one.bInterfaceClass == LIBUSB_CLASS_COMM && out.control < 0) {
      out.control = one.bInterfaceNumber;
    }
    if (one.bInterfaceClass != LIBUSB_CLASS_DATA || out.whole()) {
      continue;
    }
    out.data = one.bInterfaceNumber;
    for (int e = 0; e < one.bNumEndpoints; ++e) {
      const libusb_endpoint_descriptor& end = one.endpoint[e];
      if ((end.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) == LIBUSB_TRANSFER_TYPE_BULK) {
        ((end.bEndpointAddress & LIBUSB_ENDPOINT_IN) != 0 ? out.in : out.out) = end.bEndpointAddress;
      }
    }
  }
  libusb_free_config_descriptor(config);
  return out;
}

std::string string_of(libusb_device_handle* handle, std::uint8_t index) {
  std::array<unsigned char, 256> text{};
  const int length =
      index == 0 ? 0 : libusb_get_string_descriptor_ascii(handle, index, text.data(), text.size());
  return length > 0
             ? std::string(reinterpret_cast<const char*>(text.data()), static_cast<std::size_t>(length))
             : std::string();
}

/// Calls back with each device and its descriptor until the callback says that it has what it wants.
template <class Callback>
int for_each_device(libusb_context* context, const Callback& callback) {
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(context, &list);
  if (count < 0) {
    return static_cast<int>(count);
  }
  for (ssize_t k = 0; k < count; ++k) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(list[k], &descriptor) == 0 && callback(list[k], descriptor)) {
      break;
    }
  }
  libusb_free_device_list(list, 1);
  return 0;
}

}  // namespace

std::optional<UsbName> UsbName::parse(std::string_view text) {
  const auto hex = [](std::string_view digits) -> std::optional<std::uint16_t> {
    std::uint16_t value = 0;
    const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    return digits.size() == 4 && problem == std::errc{} && end == digits.data() + digits.size()
               ? std::optional(value)
               : std::nullopt;
  };
  if (text.size() < 9 || text[4] != ':' || (text.size() > 9 && text[9] != ':')) {
    return std::nullopt;
  }
  const auto vendor = hex(text.substr(0, 4));
  const auto product = hex(text.substr(5, 4));
  if (!vendor || !product) {
    return std::nullopt;
  }
  return UsbName{*vendor, *product, std::string(text.size() > 10 ? text.substr(10) : std::string_view{})};
}

std::string UsbName::text() const {
  char out[16];
  std::snprintf(out, sizeof out, "%04x:%04x", vendor, product);
  return serial.empty() ? out : out + (":" + serial);
}

Error usb_error(int number, const std::string& doing, const std::string& where) {
  switch (number) {
    case LIBUSB_ERROR_ACCESS:
      return {ErrorKind::kDevice, "no right to use the controller", where,
              "join the group plugdev, or copy 60-dubsar.rules to /etc/udev/rules.d; then plug it in again"};
    case LIBUSB_ERROR_BUSY:
      return {ErrorKind::kDevice, "the controller is in use by another program", where,
              "close what talks to it, then try again"};
    case LIBUSB_ERROR_NO_DEVICE:
    case LIBUSB_ERROR_NOT_FOUND:
    case LIBUSB_ERROR_IO:
    case LIBUSB_ERROR_PIPE:
      return {ErrorKind::kDevice, "the controller was unplugged or is not there", where,
              "see to its cable, and that its laser is off; dubsar drivers lists those that are"};
    default:
      return {ErrorKind::kDevice, doing + ": " + libusb_strerror(number), where, "plug it in again"};
  }
}

Result<std::unique_ptr<UsbLink>> UsbLink::open(const UsbName& name) {
  std::unique_ptr<UsbLink> out(new UsbLink());
  out->name_ = name;
  // A context of its own, so that it sees what is plugged in now.
  if (const int failed = libusb_init(&out->context_); failed != 0) {
    return std::unexpected(usb_error(failed, "USB cannot be used here", name.text()));
  }
  int refused = LIBUSB_ERROR_NOT_FOUND;
  const int listed =
      for_each_device(out->context_, [&](libusb_device* device, const libusb_device_descriptor& found) {
        if (found.idVendor != name.vendor || found.idProduct != name.product) {
          return false;
        }
        libusb_device_handle* handle = nullptr;
        refused = libusb_open(device, &handle);
        if (refused != 0) {
          return false;
        }
        out->serial_ = string_of(handle, found.iSerialNumber);
        if (!name.serial.empty() && out->serial_ != name.serial) {
          libusb_close(handle);
          refused = LIBUSB_ERROR_NOT_FOUND;
          return false;
        }
        out->product_ = string_of(handle, found.iProduct);
        out->handle_ = handle;
        return true;
      });
  if (out->handle_ == nullptr) {
    return std::unexpected(
        usb_error(listed != 0 ? listed : refused, "the controller cannot be opened", name.text()));
  }
  if (const Status claimed = out->claim(); !claimed) {
    return std::unexpected(claimed.error());
  }
  return out;
}

Status UsbLink::claim() {
  const Interfaces found = interfaces_of(libusb_get_device(handle_));
  if (!found.whole()) {
    return fail(ErrorKind::kDevice, "the controller is no serial line of the standard kind (CDC-ACM)",
                name_.text(), "dubsar drivers lists those that are");
  }
  in_ = found.in;
  out_ = found.out;
  libusb_set_auto_detach_kernel_driver(handle_, 1);
  for (const auto& [interface, keep] :
       {std::pair(found.control, &control_interface_), std::pair(found.data, &data_interface_)}) {
    if (interface < 0) {
      continue;
    }
    int failed = libusb_claim_interface(handle_, interface);
    // A program that died may have left its guard at work for a moment.
    for (const auto until = Clock::now() + kBusyFor; failed == LIBUSB_ERROR_BUSY && Clock::now() < until;) {
      std::this_thread::sleep_for(kBusyFor / 20);
      failed = libusb_claim_interface(handle_, interface);
    }
    if (failed != 0) {
      return std::unexpected(usb_error(failed, "the controller cannot be claimed", name_.text()));
    }
    *keep = interface;
  }
  const auto to = static_cast<std::uint16_t>(found.control < 0 ? found.data : found.control);
  unsigned char coding[7] = {0x00, 0xC2, 0x01, 0x00, 0, 0, 8};  // 115200, one stop bit, no parity
  // What is no real serial line behind its chip may refuse both.
  libusb_control_transfer(handle_, kToInterface, kSetLineCoding, 0, to, coding, sizeof coding, kTransferMs);
  libusb_control_transfer(handle_, kToInterface, kSetControlLines, kReady, to, nullptr, 0, kTransferMs);
  return {};
}

UsbLink::~UsbLink() {
  if (handle_ != nullptr) {
    for (const int interface : {data_interface_, control_interface_}) {
      if (interface >= 0) {
        libusb_release_interface(handle_, interface);
      }
    }
    libusb_close(handle_);
  }
  if (context_ != nullptr) {
    libusb_exit(context_);
  }
}

Status UsbLink::write(std::string_view bytes) {
  std::string copy(bytes);  // libusb wants it writable
  std::size_t sent = 0;
  while (sent < copy.size()) {
    int now = 0;
    const int failed =
        libusb_bulk_transfer(handle_, out_, reinterpret_cast<unsigned char*>(copy.data() + sent),
                             static_cast<int>(copy.size() - sent), &now, kTransferMs);
    sent += static_cast<std::size_t>(now);
    if (failed != 0) {
      return std::unexpected(usb_error(failed, "the controller takes no bytes", name_.text()));
    }
  }
  return {};
}

Result<std::string> UsbLink::read(std::chrono::milliseconds timeout) {
  std::array<unsigned char, 512> bytes{};
  int got = 0;
  // 0 would mean for ever.
  const auto wait = static_cast<unsigned>(std::max<std::int64_t>(timeout.count(), 1));
  const int failed = libusb_bulk_transfer(handle_, in_, bytes.data(), bytes.size(), &got, wait);
  if (failed != 0 && failed != LIBUSB_ERROR_TIMEOUT) {
    return std::unexpected(usb_error(failed, "the controller sends no bytes", name_.text()));
  }
  return std::string(reinterpret_cast<const char*>(bytes.data()), static_cast<std::size_t>(got));
}

std::vector<FoundController> find_controllers() {
  std::vector<FoundController> out;
  libusb_context* context = nullptr;
  if (libusb_init(&context) != 0) {
    return out;
  }
  for_each_device(context, [&](libusb_device* device, const libusb_device_descriptor& found) {
    if (interfaces_of(device).whole()) {
      FoundController one{{found.idVendor, found.idProduct, {}}, "a serial line over USB"};
      libusb_device_handle* handle = nullptr;
      if (libusb_open(device, &handle) == 0) {
        one.product = string_of(handle, found.iProduct);
        one.name.serial = string_of(handle, found.iSerialNumber);
        libusb_close(handle);
      }
      out.push_back(std::move(one));
    }
    return false;
  });
  libusb_exit(context);
  return out;
}

}  // namespace dubsar::usb_stage
