// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// usb_stage_guard VID:PID[:SERIAL] HEX: waits on standard input. A byte there: all is well, go home. Its end
// without one: the program died; open the controller and send the bytes, which put its lasers off.
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "drivers/usb_stage/usb_link.h"

namespace {

using namespace dubsar;
using namespace std::chrono_literals;

std::string bytes_from(const std::string& hex) {
  std::string out;
  for (std::size_t k = 0; k + 1 < hex.size(); k += 2) {
    out += static_cast<char>(std::strtoul(hex.substr(k, 2).c_str(), nullptr, 16));
  }
  return out;
}

}  // namespace

int main(int count, char** words) {
  if (count != 3) {
    std::fputs("usb_stage_guard VID:PID[:SERIAL] HEX; started by the usb_stage driver\n", stderr);
    return 2;
  }
  const std::optional<usb_stage::UsbName> name = usb_stage::UsbName::parse(words[1]);
  const std::string bytes = bytes_from(words[2]);
  if (!name || bytes.empty()) {
    return 2;
  }
  // What ends the program must not end its guard: Ctrl-C goes to all of a terminal's processes.
  ::setsid();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) {
    std::signal(signal, SIG_IGN);
  }
  if (::write(1, ".", 1) != 1) {
    return 4;
  }
  ::close(1);
  char said = 0;
  ssize_t got = 0;
  do {
    got = ::read(0, &said, 1);
  } while (got < 0 && errno == EINTR);
  if (got == 1) {
    return 0;
  }
  // The kernel takes the line from the dead program within moments; a controller may be out for a restart.
  const auto until = std::chrono::steady_clock::now() + 10s;
  while (std::chrono::steady_clock::now() < until) {
    if (const auto link = usb_stage::UsbLink::open(*name); link && (*link)->write(bytes)) {
      // What it answers is of no use to anybody, but must not clog its line while it works.
      const auto enough = std::chrono::steady_clock::now() + 500ms;
      for (auto answer = (*link)->read(100ms);
           answer && !answer->empty() && std::chrono::steady_clock::now() < enough;) {
        answer = (*link)->read(100ms);
      }
      return 0;
    }
    std::this_thread::sleep_for(100ms);
  }
  std::fprintf(stderr, "dubsar: %s: the laser could not be put off; pull its plug\n", words[1]);
  return 3;
}
