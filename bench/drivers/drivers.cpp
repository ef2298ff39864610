// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// dubsar-drivers frames|unplug v4l2|aravis|usb_stage [N] [RATE] [WIDTHxHEIGHT] [OPTION=VALUE...]: the drivers
// of devices against the emulated ones of the tests, each in a process of its own behind the kernel's
// interface (FUSE, GigE packets on a loopback, umockdev).
//   frames: N frames (usb_stage: N positions) at RATE; lost ones, and what each side has counted of them, and
//           memory at the start and at the end. OPTION is one of the driver's;
//           v4l2 with format=MJPG sends motion JPEG.
//   unplug: the cable is pulled at N random moments; how long until the driver says so, and that it goes on.
#include <dlfcn.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "bench/drivers/driver_words.h"
#include "bench/drivers/processor_watch.h"
#include "build_paths.h"
#include "core/stage_times.h"
#include "core/thread_priority.h"
#include "drivers/loader.h"
#include "tests/support/own_network.h"
#include "tests/support/peer_process.h"
#include "tests/support/temporary_folder.h"

namespace {

using namespace dubsar;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Words = std::vector<std::string>;
using Options = std::vector<std::pair<std::string, std::string>>;

const std::string kBin = DUBSAR_BINARY_DIR "/bin/";

/// Megabytes that this process holds.
double resident_mb() {
  std::ifstream file("/proc/self/status");
  for (std::string word; file >> word;) {
    if (word == "VmRSS:") {
      double kilobytes = 0;
      file >> kilobytes;
      return kilobytes / 1024;
    }
  }
  return 0;
}

[[noreturn]] void give_up(const std::string& why) {
  std::fprintf(stderr, "dubsar-drivers: %s\n", why.c_str());
  std::exit(3);
}

template <class T>
T must(Result<T> result) {
  if (!result) {
    give_up(result.error().line());
  }
  return std::move(*result);
}
void must(const Status& status) {
  if (!status) {
    give_up(status.error().line());
  }
}

/// An emulated device that can be unplugged and plugged in.
struct Emulated {
  std::string scheme, locator;
  Options options;
  std::function<void()> unplug, plug;
  /// Whether the laser burns, as the controller itself has it; and the cable back to a controller that had
  /// power of its own all the while.
  std::function<bool()> lit = [] { return false; };
  std::function<void()> rejoin = [this] { plug(); };
  /// Frames that the device itself made, those it lost for want of a buffer, and how often it was held up.
  std::function<std::string()> counts = [] { return std::string(); };
  /// Of one frame, whether its pixels are those of its number.
  std::function<bool(const Frame&)> genuine = [](const Frame&) { return true; };
};

Device open(const DriverRegistry& registry, const Emulated& device) {
  return must((*registry.find(device.scheme))->open(device.locator, device.options));
}

std::uint32_t painted_number(const Frame& frame) {
  std::uint32_t out = 0;
  std::memcpy(&out, frame.pixels.data(), sizeof out);
  return out;
}

int count_frames(Device& device, const Emulated& emulated, std::uint64_t count) {
  prefer_this_thread();  // as the thread of a scan that takes frames
  must(device.start_frames(0));
  std::uint64_t wrong = 0;
  std::uint64_t bytes = 0;
  double before_mb = 0;
  Clock::time_point start{};
  double longest_s = 0;  // that this thread was away
  std::optional<ProcessorWatch> watch;
  for (std::uint64_t k = 0; k < count; ++k) {
    const Clock::time_point back = Clock::now();
    auto frame = must(device.next_frame(20s));  // the whole machine may stand still for a while
    if (!frame) {
      const FrameCounters now = must(device.frame_counters());
      give_up("no frame in 20 s after " + std::to_string(k) + ": " + std::to_string(now.lost) +
              " lost before, " + std::to_string(now.starved) + " of all for want of a buffer, taken anew " +
              std::to_string(now.reconnections) + " times, pool " + std::to_string(now.pool) +
              "; the device made, lost, was held up: " + emulated.counts() + ", then " + emulated.counts());
    }
    const Clock::time_point taken = Clock::now();
    wrong += emulated.genuine(*frame) ? 0 : 1;
    bytes += frame->pixels.size();
    if (k == count / 10) {
      before_mb = resident_mb();
    }
    if (k == 0) {
      start = Clock::now();
      watch.emplace();
    }
    frame.reset();
    longest_s = std::max({longest_s, k == 0 ? 0 : seconds_since(taken),
                          k == 0 ? 0 : std::chrono::duration<double>(taken - back).count()});
  }
  const double seconds = seconds_since(start);
  const double after_mb = resident_mb();
  must(device.stop_frames());
  const FrameCounters counts = must(device.frame_counters());
  std::printf(
      "%s: %llu frames, %.1f/s, %.0f MB/s, %llu lost, %llu late, %llu with wrong pixels, memory %.1f to %.1f "
      "MB\n"
      "  driver: pool %u, %llu lost for want of a buffer, %llu packets sent again, taken anew %llu times; "
      "longest wait or hold of the taking thread %.3f s, of a processor away %.3f s\n"
      "  device: made, lost for want of a buffer, held up: %s\n",
      emulated.scheme.c_str(), static_cast<unsigned long long>(counts.delivered),
      static_cast<double>(count - 1) / seconds, static_cast<double>(bytes) / seconds / 1e6,
      static_cast<unsigned long long>(counts.lost), static_cast<unsigned long long>(counts.late),
      static_cast<unsigned long long>(wrong), before_mb, after_mb, counts.pool,
      static_cast<unsigned long long>(counts.starved), static_cast<unsigned long long>(counts.resent),
      static_cast<unsigned long long>(counts.reconnections), longest_s, watch ? watch->longest_s() : 0.0,
      emulated.counts().c_str());
  return counts.lost == 0 && wrong == 0 && after_mb < before_mb * 1.05 + 2 ? 0 : 1;
}

int count_positions(Device& device, std::uint64_t count) {
  must(device.home());
  must(device.move({.axis = 0, .position = -150, .speed = 0.5, .start_only = true}));
  std::uint64_t backwards = 0;
  double before_mb = 0;
  double last = 1;
  const Clock::time_point start = Clock::now();
  for (std::uint64_t k = 0; k < count; ++k) {
    const StageReading motion = must(device.motion());
    backwards += motion.position[0] > last ? 1 : 0;
    last = motion.position[0];
    if (k == count / 10) {
      before_mb = resident_mb();
    }
  }
  const double seconds = seconds_since(start);
  must(device.stop());
  std::printf("usb_stage: %llu positions, %.0f/s, %llu out of order, memory %.1f to %.1f MB\n",
              static_cast<unsigned long long>(count), static_cast<double>(count) / seconds,
              static_cast<unsigned long long>(backwards), before_mb, resident_mb());
  return backwards == 0 ? 0 : 1;
}

/// Rows of a scan, until the sink has had enough.
struct Rows : ProfileSink {
  bool begin(const ScanInfo& /*info*/) override { return true; }
  bool profile(const Profile& /*profile*/) override {
    ++rows;
    if (rows == when && pull) {
      pull();
    }
    return rows < most;
  }
  void end(const ScanTally& at) override { tally = at; }
  std::uint64_t rows = 0;
  std::uint64_t when = 0;
  std::uint64_t most = ~std::uint64_t{0};
  std::function<void()> pull;
  std::optional<ScanTally> tally;
};

/// Seconds from the pull to the driver's word of a stream, a scan or a move.
double pull_once(Device& device, const Emulated& emulated, std::mt19937& random) {
  Clock::time_point pulled{};
  const auto pull = [&] {
    emulated.unplug();
    pulled = Clock::now();
  };
  std::optional<Error> said;
  if (device.capabilities()->is_stage) {
    if (device.axes()->front().can_home) {
      must(device.home());
    }
    must(device.set_laser(0, 1));
    must(device.move({.axis = 0, .position = -20, .speed = 1, .start_only = true}));
    for (auto looks = random() % 100; looks > 0; --looks) {
      must(device.motion());
    }
    pull();
    while (!said) {
      const auto motion = device.motion();
      said = motion ? std::nullopt : std::optional(motion.error());
    }
  } else if (device.capabilities()->yields_frames) {
    must(device.start_frames(0));
    for (auto frames = random() % 60; frames > 0; --frames) {
      must(device.next_frame(2s));
    }
    pull();
    while (!said) {
      const auto frame = device.next_frame(60s);
      said = frame ? std::nullopt : std::optional(frame.error());
    }
  } else {
    Rows rows;
    rows.when = 1 + random() % 400;
    rows.pull = pull;
    const auto scanned = device.scan(rows);
    if (scanned || !rows.tally || rows.tally->profiles_sent != rows.rows || rows.rows < rows.when) {
      give_up("rows were lost with the cable");
    }
    said = scanned.error();
  }
  const double seconds = seconds_since(pulled);
  if (said->kind != ErrorKind::kDevice) {
    give_up("not told as a device error: " + said->line());
  }
  return seconds;
}

int count_pulls(Device& device, const Emulated& emulated, std::uint64_t count) {
  std::mt19937 random(2026);
  std::vector<double> seconds;
  const bool is_stage = device.capabilities()->is_stage;
  std::uint64_t burning = 0;
  std::uint64_t left_on = 0;
  for (std::uint64_t k = 0; k < count; ++k) {
    seconds.push_back(pull_once(device, emulated, random));
    // In turns a board that lives on the cable, and one that burns the laser on: the first word to it puts it
    // off.
    burning += emulated.lit() ? 1 : 0;
    k % 2 == 0 ? emulated.plug() : emulated.rejoin();
    if (is_stage) {
      must(device.motion());
      left_on += emulated.lit() ? 1 : 0;
    }
  }
  // It goes on after the last one too.
  if (device.capabilities()->is_stage) {
    must(device.motion());
  } else if (device.capabilities()->yields_frames) {
    must(device.start_frames(0));
    must(device.next_frame(2s));
  } else {
    Rows rows;
    rows.most = 10;
    if (const auto scanned = device.scan(rows); scanned || rows.rows != 10) {
      give_up("it does not go on");
    }
  }
  std::ranges::sort(seconds);
  if (is_stage) {
    std::printf("%s: the laser burnt at %llu of the pulls, and at %llu after the cable was back\n",
                emulated.scheme.c_str(), static_cast<unsigned long long>(burning),
                static_cast<unsigned long long>(left_on));
  }
  std::printf(
      "%s: unplugged %llu times: told after %.3f s at the median, %.3f s at most; went on each time\n",
      emulated.scheme.c_str(), static_cast<unsigned long long>(count), seconds[seconds.size() / 2],
      seconds.back());
  return seconds.back() <= 2 && left_on == 0 ? 0 : 1;
}

/// The emulated device of a scheme. What it needs lives as long as this.
class Stand {
 public:
  Stand(const std::string& scheme, bool frames, const std::string& rate, const std::string& size,
        const Options& options) {
    device.scheme = scheme;
    if (scheme == "v4l2") {
      const auto asked = std::ranges::find(options, "format", &Options::value_type::first);
      const std::string format = asked == options.end() ? "GREY" : asked->second;
      start({kBin + "v4l2_peer", folder_.path().string(), "Bench", format + ":" + size + "@" + rate});
      device.locator = (folder_.path() / "video0").string();
      device.unplug = [this] { peer_->tell("unplug"); };
      device.plug = [this] { peer_->tell("plug"); };
      if (format == "GREY") {  // the others do not keep every bit
        device.genuine = [](const Frame& frame) { return painted_number(frame) + 1 == frame.id; };
      }
    } else if (scheme == "aravis") {
      const Words words{kBin + "gige_peer", "SN7", folder_.path().string()};
      start(words);
      device.locator = "Dubsar-Range 1-SN7";
      device.options = frames ? Options{{"format", "Mono8"}} : Options{{"rows", "1000000"}};
      device.unplug = [this] {
        ::kill(peer_->pid(), SIGKILL);
        peer_.reset();
      };
      device.plug = [this, words] { start(words); };
      if (frames) {
        peer_->tell("write 138 " + std::to_string(1000000 / std::stoi(rate)));
        const std::size_t cross = size.find('x');
        peer_->tell("write 100 " + size.substr(0, cross));
        peer_->tell("write 104 " + size.substr(cross + 1));
        // It counts from where it likes; numbers of GigE Vision 1 go round at 65535.
        device.genuine = [first = std::optional<std::int64_t>()](const Frame& frame) mutable {
          const std::int64_t ahead = (std::int64_t{painted_number(frame)} - frame.id % 65535 + 65535) % 65535;
          first = first.value_or(ahead);
          return ahead == *first;
        };
      }
    } else {
      peer_.emplace(test::PeerProcess::HandedOver{std::getenv("DUBSAR_BENCH_PEER")});
      device.locator = "2341:0043";
      device.unplug = [this] { peer_->tell("unplug"); };
      device.plug = [this] { peer_->tell("plug"); };
      device.rejoin = [this] { peer_->tell("rejoin"); };
      device.lit = [this] { return peer_->tell("laser") != "0"; };
    }
    if (scheme != "usb_stage") {
      device.counts = [this] { return peer_->tell("counts"); };
    }
    device.options.insert(device.options.end(), options.begin(), options.end());
  }
  Emulated device;

 private:
  void start(const Words& words) {
    peer_.emplace(words);
    if (!peer_->refusal().empty()) {
      give_up(peer_->refusal());
    }
  }
  test::TemporaryFolder folder_;
  std::optional<test::PeerProcess> peer_;
};

/// umockdev works by a preloaded library: the program becomes itself again with it.
void become_preloaded(char** words) {
  test::PeerProcess one(Words{kBin + "usb_peer"});
  constexpr const char* kLibrary = "libumockdev-preload.so.0";
  if (!one.refusal().empty() || ::dlopen(kLibrary, RTLD_LAZY) == nullptr) {
    give_up("no emulated USB here: " + one.refusal());
  }
  ::setenv("LD_PRELOAD", kLibrary, 1);
  ::setenv("UMOCKDEV_DIR", one.greeting().c_str(), 1);
  ::setenv("DUBSAR_BENCH_PEER", one.hand_over().c_str(), 1);
  ::execv("/proc/self/exe", words);
  give_up("cannot start itself");
}

}  // namespace

int main(int count, char** words) {
  bench::DriverWords asked;
  if (const auto status = asked.read(count, words)) {
    return *status;
  }
  const std::uint64_t n = asked.count;
  const std::string& scheme = asked.scheme;
  if (scheme == "usb_stage" && std::getenv("DUBSAR_BENCH_PEER") == nullptr) {
    become_preloaded(words);
  }
  if (scheme == "aravis" && !test::enter_own_network()) {
    give_up("this kernel gives nobody a network of his own");
  }
  const DriverRegistry registry({std::filesystem::path(DUBSAR_BINARY_DIR) / "lib/dubsar/drivers"});
  Stand stand(scheme, asked.what == "frames", std::to_string(asked.rate_hz), asked.size, asked.options);
  Device device = open(registry, stand.device);
  if (asked.what == "unplug") {
    return count_pulls(device, stand.device, n);
  }
  return scheme == "usb_stage" ? count_positions(device, n) : count_frames(device, stand.device, n);
}
