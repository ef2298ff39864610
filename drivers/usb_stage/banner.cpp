// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Which firmware a controller has, where nobody says.
#include <string>

#include "drivers/usb_stage/firmware.h"

namespace dubsar::usb_stage {

namespace {

using namespace std::chrono_literals;

constexpr auto kBoot = 3500ms;  // of a board that restarts when its line is opened
constexpr auto kAskEvery = 500ms;
constexpr std::size_t kPart = 16;  // of a banner that may be in two pieces, at most

}  // namespace

Result<std::unique_ptr<Firmware>> make_by_banner(Link& link, const std::vector<AxisWish>& axes,
                                                 const std::string& where) {
  std::string said;
  const Clock::time_point until = Clock::now() + kBoot;
  while (Clock::now() < until) {
    if (const Status sent = link.write("\x18\r\n"); !sent) {
      return std::unexpected(sent.error());
    }
    const Clock::time_point again = std::min(Clock::now() + kAskEvery, until);
    while (Clock::now() < again) {
      const Result<std::string> bytes =
          link.read(std::chrono::ceil<std::chrono::milliseconds>(again - Clock::now()));
      if (!bytes) {
        return std::unexpected(bytes.error());
      }
      said += *bytes;
      if (said.find("Grbl ") != said.npos) {
        return make_grbl(link, axes, where);
      }
      if (said.find("Horus ") != said.npos) {
        return make_horus(link, axes, where);
      }
      said.erase(0, said.size() - std::min(said.size(), kPart));
    }
  }
  return fail(ErrorKind::kDevice, "the controller says neither that it is GRBL nor that it is Horus", where,
              "give firmware=tmcl with its steps=, or see to its firmware");
}

}  // namespace dubsar::usb_stage
