// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// usb_stage_guard VID:PID[:SERIAL] HEX: waits on standard input. '.' there: all is well, go home. '!': a
// laser is on; from now on look whether the program was suspended, and have it end then. '-': all are off.
// '?': the controller cannot be reached, and its laser may be on; look for it, and send it the bytes, which
// put its lasers off, as soon as it is there. The end of it, without a word: the program died; do the same.
#include <fcntl.h>
#include <poll.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
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

constexpr char kAllWell = '.';
constexpr char kLit = '!';
constexpr char kDark = '-';
constexpr char kEnded = 0;     // the program did
constexpr char kNothing = -1;  // was said in time
constexpr int kForEver = -1;
constexpr std::chrono::milliseconds kTryEvery = 250ms;
constexpr std::chrono::milliseconds kLookEvery = 500ms;  ///< at a program whose laser is on
/// Behind the program's end: whoever waits for all that it writes does not wait for the guard any longer.
constexpr auto kTellAfter = 10s;
constexpr auto kGiveUpAfter = 10min;

/// The next word of the program.
char listen(int timeout_ms) {
  pollfd waiting{0, POLLIN, 0};
  int heard = 0;
  char said = kEnded;
  ssize_t got = 0;
  do {
    heard = ::poll(&waiting, 1, timeout_ms);
    got = heard > 0 ? ::read(0, &said, 1) : 0;
  } while ((heard < 0 || got < 0) && errno == EINTR);
  return heard == 0 ? kNothing : got == 1 ? said : kEnded;
}

/// By job control, as Ctrl-Z does it (T of proc(5)); one that a debugger holds is not.
bool is_suspended(pid_t program) {
  std::ifstream file("/proc/" + std::to_string(program) + "/stat");
  std::string line;
  std::getline(file, line);
  const std::size_t name_ends = line.rfind(')');
  return name_ends != std::string::npos && line.compare(name_ends, 3, ") T") == 0;
}

/// The first word that is not about lasers. A program that is suspended holds the controller's line, so that
/// nobody else can put its laser off: it is woken up, and ends as by Ctrl-C.
char listen_and_look(const usb_stage::UsbName& name, pid_t program) {
  for (bool lit = false;;) {
    const char said = listen(lit ? static_cast<int>(kLookEvery.count()) : kForEver);
    if (said == kLit || said == kDark) {
      lit = said == kLit;
    } else if (said != kNothing) {
      return said;
    } else if (is_suspended(program) && ::getppid() == program) {
      std::fprintf(stderr, "dubsar: %s: suspended with its laser on; the program is ended\n",
                   name.text().c_str());
      ::kill(program, SIGTERM);
      ::kill(program, SIGCONT);
    }
  }
}

/// Whether the bytes went out.
bool put_off(const usb_stage::UsbName& name, const std::string& bytes) {
  const auto link = usb_stage::UsbLink::open(name);
  if (!link || !(*link)->write(bytes)) {
    return false;
  }
  // What it answers is of no use to anybody, but must not clog its line while it works.
  const auto enough = std::chrono::steady_clock::now() + 500ms;
  for (auto answer = (*link)->read(100ms);
       answer && !answer->empty() && std::chrono::steady_clock::now() < enough;) {
    answer = (*link)->read(100ms);
  }
  return true;
}

/// Behind the program's end. Whether it came to that.
bool put_off_alone(const usb_stage::UsbName& name, const std::string& bytes) {
  const auto since = std::chrono::steady_clock::now();
  // The kernel takes the line from the dead program within moments; a controller may be out for a restart.
  for (bool told = false; std::chrono::steady_clock::now() < since + kGiveUpAfter;) {
    if (put_off(name, bytes)) {
      return true;
    }
    if (!told && std::chrono::steady_clock::now() > since + kTellAfter) {
      std::fprintf(stderr, "dubsar: %s: the laser could not be put off; pull its plug\n",
                   name.text().c_str());
      if (const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC); nowhere >= 0) {
        ::dup2(nowhere, 2);
        ::close(nowhere);
      }
      told = true;
    }
    std::this_thread::sleep_for(kTryEvery);
  }
  return false;
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
  const pid_t program = ::getppid();
  // What ends the program must not end its guard: Ctrl-C goes to all of a terminal's processes.
  ::setsid();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) {
    std::signal(signal, SIG_IGN);
  }
  // Nor must one that waits for minutes hold what the program left open, or a disk that is to be taken out.
  ::close_range(3, ~0U, 0);
  if (::chdir("/") != 0 || ::write(1, ".", 1) != 1) {
    return 4;
  }
  ::close(1);
  char said = listen_and_look(*name, program);
  while (said != kAllWell && said != kEnded) {
    if (put_off(*name, bytes)) {
      return 0;
    }
    said = listen(static_cast<int>(kTryEvery.count()));
  }
  return said == kAllWell || put_off_alone(*name, bytes) ? 0 : 3;
}
