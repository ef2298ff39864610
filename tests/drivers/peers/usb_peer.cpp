// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// usb_peer: a USB controller (CDC-ACM, 2341:0043) at the kernel's interface: umockdev's /sys and /dev for
// whoever has its library preloaded and $UMOCKDEV_DIR as told, with the ioctls of usbfs answered here by a
// firmware simulation. Says "ready DIR"; commands on standard input: firmware NAME, laser, at, unplug, plug
// (a board that lives on the cable starts anew), rejoin (one with power of its own goes on), mute, talk,
// babble, impossible, possible, stick, slip, power_up, publish FILE (tells others where it is).
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <umockdev.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <thread>

#include "core/thread_priority.h"
#include "tests/drivers/peers/firmware_sims.h"

namespace {

constexpr const char* kDevice = "/dev/bus/usb/001/002";

// Device, configuration, a communication interface with its interrupt endpoint, a data interface with two
// bulk ones.
constexpr std::uint8_t kDescriptors[] = {
    18, 1,    0,    2,    2, 0,  0,    64,   0x41, 0x23, 0x43, 0,    0, 1, 1, 2,    3, 1,     //
    9,  2,    67,   0,    2, 1,  0,    0x80, 50,                                              //
    9,  4,    0,    0,    1, 2,  2,    1,    0,                                               //
    5,  0x24, 0,    0x10, 1, 5,  0x24, 1,    0,    1,    4,    0x24, 2, 2, 5, 0x24, 6, 0, 1,  //
    7,  5,    0x82, 3,    8, 0,  10,                                                          //
    9,  4,    1,    0,    2, 10, 0,    0,    0,                                               //
    7,  5,    0x81, 2,    0, 2,  0,                                                           //
    7,  5,    0x01, 2,    0, 2,  0};

struct Urb {
  UMockdevIoctlData* urb;
  UMockdevIoctlData* bytes;
  [[nodiscard]] usbdevfs_urb& get() const { return *reinterpret_cast<usbdevfs_urb*>(urb->data); }
};

struct Peer {
  std::unique_ptr<dubsar::test::FirmwareSim> firmware = dubsar::test::make_firmware_sim("grbl");
  UMockdevTestbed* testbed = nullptr;
  /// Of each open file: a program that died must not have its transfers handed to the next.
  struct File {
    std::deque<Urb> waiting, done;
  };
  std::map<UMockdevIoctlClient*, File> files;
  UMockdevIoctlClient* owner = nullptr;  ///< of the interfaces
  UMockdevIoctlClient* dying = nullptr;  ///< an owner that need not be asked
  bool kernel_driver = true, plugged = true, mute = false;
  std::string babble;
  std::optional<dubsar::test::SharedLaw> law;
};
Peer peer;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void feed(Peer::File& file, std::string& out) {
  while (!out.empty() && !file.waiting.empty()) {
    const Urb urb = file.waiting.front();
    file.waiting.pop_front();
    const std::size_t count =
        std::min<std::size_t>(out.size(), static_cast<std::size_t>(urb.get().buffer_length));
    std::memcpy(urb.bytes->data, out.data(), count);
    out.erase(0, count);
    urb.get().actual_length = static_cast<int>(count);
    urb.get().status = 0;
    file.done.push_back(urb);
  }
}

/// What the firmware said goes to those who wait for bytes.
void feed() {
  std::string& out = peer.firmware->out;
  if (!peer.babble.empty()) {
    out = peer.babble + out;
    peer.babble.clear();
  }
  if (peer.mute) {
    out.clear();
  }
  for (auto& [client, file] : peer.files) {
    feed(file, out);
  }
}

void control(const Urb& urb) {
  const std::uint8_t* setup = urb.bytes->data;
  std::uint8_t* data = urb.bytes->data + 8;
  const std::size_t length = setup[6] | static_cast<std::size_t>(setup[7]) << 8U;
  const auto answer = [&](const std::uint8_t* bytes, std::size_t count) {
    count = std::min(count, length);
    std::memcpy(data, bytes, count);
    urb.get().actual_length = static_cast<int>(count);
  };
  urb.get().status = 0;
  urb.get().actual_length = 0;
  switch (setup[0] << 8U | setup[1]) {
    case 0x8006: {  // strings
      const char* texts[] = {"", "Dubsar", "Stage peer", "SN-42"};
      if (setup[3] != 3 || setup[2] > 3) {
        urb.get().status = -EPIPE;
        break;
      }
      std::uint8_t text[64] = {4, 3, 9, 4};
      if (setup[2] > 0) {
        const std::size_t count = std::strlen(texts[setup[2]]);
        text[0] = static_cast<std::uint8_t>(2 + 2 * count);
        for (std::size_t k = 0; k < count; ++k) {
          text[2 + 2 * k] = static_cast<std::uint8_t>(texts[setup[2]][k]);
          text[3 + 2 * k] = 0;
        }
      }
      answer(text, text[0]);
      break;
    }
    case 0x2120:  // line coding
      urb.get().actual_length = 7;
      break;
    case 0x2122:  // control lines
      break;
    default:
      urb.get().status = -EPIPE;
  }
}

int submit(Peer::File& file, UMockdevIoctlData* argument) {
  GError* error = nullptr;
  Urb urb{umockdev_ioctl_data_resolve(argument, 0, sizeof(usbdevfs_urb), &error), nullptr};
  usbdevfs_urb& asked = urb.get();
  urb.bytes = umockdev_ioctl_data_resolve(urb.urb, offsetof(usbdevfs_urb, buffer),
                                          static_cast<gsize>(asked.buffer_length), &error);
  if (asked.type == USBDEVFS_URB_TYPE_CONTROL) {
    control(urb);
    file.done.push_back(urb);
  } else if (asked.endpoint == 0x01) {
    peer.firmware->take(
        {reinterpret_cast<const char*>(urb.bytes->data), static_cast<std::size_t>(asked.buffer_length)},
        now());
    asked.actual_length = asked.buffer_length;
    asked.status = 0;
    file.done.push_back(urb);
    feed();
  } else if (asked.endpoint == 0x81) {
    file.waiting.push_back(urb);
    feed();
  } else {
    return EINVAL;
  }
  return 0;
}

void publish() {
  if (peer.law) {
    peer.law->write(peer.firmware->law());
  }
}

gboolean handle_request(UMockdevIoctlClient* client) {
  const gulong request = umockdev_ioctl_client_get_request(client);
  UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
  GError* error = nullptr;
  Peer::File& file = peer.files[client];
  const auto answer = [&](long result, int number) {
    umockdev_ioctl_client_complete(client, result, number);
    return TRUE;
  };
  if (!peer.plugged && request != USBDEVFS_REAPURBNDELAY && request != USBDEVFS_DISCARDURB) {
    return answer(-1, ENODEV);
  }
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES: {
      UMockdevIoctlData* data = umockdev_ioctl_data_resolve(argument, 0, sizeof(std::uint32_t), &error);
      const std::uint32_t can = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_BULK_CONTINUATION |
                                USBDEVFS_CAP_NO_PACKET_SIZE_LIM | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
      std::memcpy(data->data, &can, sizeof can);
      g_object_unref(data);
      return answer(0, 0);
    }
    case USBDEVFS_GETDRIVER: {
      if (!peer.kernel_driver) {
        return answer(-1, ENODATA);
      }
      UMockdevIoctlData* data = umockdev_ioctl_data_resolve(argument, 0, sizeof(usbdevfs_getdriver), &error);
      std::strcpy(reinterpret_cast<usbdevfs_getdriver*>(data->data)->driver, "cdc_acm");
      g_object_unref(data);
      return answer(0, 0);
    }
    case USBDEVFS_IOCTL:  // detaches the kernel's driver
      peer.kernel_driver = false;
      return answer(0, 0);
    case USBDEVFS_DISCONNECT_CLAIM:
    case USBDEVFS_CLAIMINTERFACE:
      peer.kernel_driver = peer.kernel_driver && request == USBDEVFS_CLAIMINTERFACE;
      if (peer.kernel_driver || (peer.owner != nullptr && peer.owner != peer.dying && peer.owner != client)) {
        return answer(-1, EBUSY);
      }
      peer.owner = client;
      return answer(0, 0);
    case USBDEVFS_RELEASEINTERFACE:
      peer.owner = nullptr;
      return answer(0, 0);
    case USBDEVFS_SETINTERFACE:
    case USBDEVFS_CLEAR_HALT:
    case USBDEVFS_SETCONFIGURATION:
      return answer(0, 0);
    case USBDEVFS_SUBMITURB: {
      const int failed = submit(file, argument);
      return answer(failed == 0 ? 0 : -1, failed);
    }
    case USBDEVFS_DISCARDURB: {
      gulong address = 0;
      std::memcpy(&address, argument->data, sizeof address);
      for (auto urb = file.waiting.begin(); urb != file.waiting.end(); ++urb) {
        if (urb->urb->client_addr == address) {
          urb->get().status = -ENOENT;
          urb->get().actual_length = 0;
          file.done.push_back(*urb);
          file.waiting.erase(urb);
          return answer(0, 0);
        }
      }
      return answer(-1, EINVAL);
    }
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY: {
      if (!peer.plugged) {
        for (; !file.waiting.empty(); file.waiting.pop_front()) {
          file.waiting.front().get().status = -ESHUTDOWN;
          file.done.push_back(file.waiting.front());
        }
      }
      // Motors that arrived have something to say without being asked.
      peer.firmware->take({}, now());
      feed();
      if (file.done.empty()) {
        return answer(-1, peer.plugged ? EAGAIN : ENODEV);
      }
      const Urb urb = file.done.front();
      file.done.pop_front();
      UMockdevIoctlData* data = umockdev_ioctl_data_resolve(argument, 0, sizeof(void*), &error);
      umockdev_ioctl_data_set_ptr(data, 0, urb.urb);
      g_object_unref(data);
      g_object_unref(urb.bytes);
      g_object_unref(urb.urb);
      return answer(0, 0);
    }
    default:
      return answer(-1, ENOTTY);
  }
}

gboolean handle(UMockdevIoctlBase* /*base*/, UMockdevIoctlClient* client, gpointer /*user*/) {
  const gboolean handled = handle_request(client);
  publish();
  return handled;
}

bool add_device() {
  std::string hex;
  for (const std::uint8_t byte : kDescriptors) {
    char text[3];
    std::snprintf(text, sizeof text, "%02X", byte);
    hex += text;
  }
  const std::string device =
      "P: /devices/pci0000:00/0000:00:14.0/usb1/1-1\nN: bus/usb/001/002=" + hex +
      "\nE: BUSNUM=001\nE: DEVNUM=002\nE: DEVNAME=/dev/bus/usb/001/002\nE: DEVTYPE=usb_device\nE: "
      "SUBSYSTEM=usb\n"
      "E: MAJOR=189\nE: MINOR=1\nE: DRIVER=usb\nE: PRODUCT=2341/43/0\nA: bConfigurationValue=1\\n\nA: "
      "busnum=1\\n\n"
      "A: devnum=2\\n\nA: speed=480\\n\nA: idVendor=2341\\n\nA: idProduct=0043\\n\nH: descriptors=" +
      hex + "\n";
  GError* error = nullptr;
  if (!umockdev_testbed_add_from_string(peer.testbed, device.c_str(), &error)) {
    std::printf("cannot: %s\n", error->message);
    return false;
  }
  UMockdevIoctlBase* handler = umockdev_ioctl_base_new();
  g_signal_connect(handler, "handle-ioctl", G_CALLBACK(handle), nullptr);
  umockdev_testbed_attach_ioctl(peer.testbed, kDevice, handler, &error);
  if (error != nullptr) {
    std::printf("cannot: %s\n", error->message);
    return false;
  }
  return true;
}

std::string command(const std::string& line) {
  std::istringstream words(line);
  std::string what;
  words >> what;
  char text[64];
  if (what == "firmware") {
    words >> what;
    peer.firmware = dubsar::test::make_firmware_sim(what);
    peer.firmware->out.clear();
    peer.mute = false;
  } else if (what == "publish") {
    words >> what;
    peer.law.emplace(what);
    if (!peer.law->works()) {
      peer.law.reset();
      return "cannot";
    }
    publish();
  } else if (what == "laser") {
    std::snprintf(text, sizeof text, "%g", peer.firmware->laser);
    return text;
  } else if (what == "at") {
    std::snprintf(text, sizeof text, "%.3f", peer.firmware->at(now()));
    return text;
  } else if (what == "unplug") {
    peer.plugged = false;  // without an event: what uses the device notices by itself
  } else if (what == "plug" || what == "power_up" || what == "rejoin") {
    peer.owner = peer.plugged ? peer.owner : nullptr;
    peer.kernel_driver = true;
    peer.plugged = true;
    if (what != "rejoin") {
      peer.firmware->power_up();
    }
    peer.firmware->out.clear();
  } else if (what == "dying") {
    peer.dying =
        peer.owner;  // the kernel will free what this program has; umockdev does not tell when it dies
  } else if (what == "mute" || what == "talk") {
    peer.mute = what == "mute";
  } else if (what == "babble") {
    peer.babble = "\x01\xff<Idle|MPos:zzz\r\n\x80\x80>>>ok?\r\n\x02\x01\x64";
  } else if (what == "impossible" || what == "possible") {
    peer.firmware->impossible = what == "impossible";
  } else if (what == "stick" || what == "slip") {
    peer.firmware->stuck = what == "stick";
  } else {
    return "what?";
  }
  return "ok";
}

}  // namespace

int main() {
  dubsar::prefer_this_thread();
  std::signal(SIGPIPE, SIG_IGN);  // clients are killed on purpose
  peer.testbed = umockdev_testbed_new();
  if (!add_device()) {
    return 2;
  }
  std::printf("ready %s\n", umockdev_testbed_get_root_dir(peer.testbed));
  std::fflush(stdout);
  GMainLoop* loop = g_main_loop_new(nullptr, FALSE);
  // Commands are carried out where the ioctls are: in the loop.
  GIOChannel* channel = g_io_channel_unix_new(0);
  g_io_add_watch(
      channel, static_cast<GIOCondition>(G_IO_IN | G_IO_HUP),
      [](GIOChannel* from, GIOCondition, gpointer to) -> gboolean {
        gchar* line = nullptr;
        gsize end = 0;
        if (g_io_channel_read_line(from, &line, nullptr, &end, nullptr) != G_IO_STATUS_NORMAL) {
          g_main_loop_quit(static_cast<GMainLoop*>(to));
          return FALSE;
        }
        std::printf("%s\n", command(std::string(line, end)).c_str());
        std::fflush(stdout);
        g_free(line);
        return TRUE;
      },
      loop);
  g_main_loop_run(loop);
  g_object_unref(peer.testbed);  // which removes its folder
  return 0;
}
