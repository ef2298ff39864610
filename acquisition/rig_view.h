// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>

#include "acquisition/rig_source.h"
#include "drivers/driver.h"

/// The rig behind the C interface.
struct dubsar_device {
  std::unique_ptr<dubsar::RigSource> source;
  std::mutex mutex{};                             ///< of what follows
  std::map<std::uint64_t, dubsar::Frame> lent{};  ///< by lease
  std::uint64_t leases = 0;
};

namespace dubsar {

/// Lets a rig be looked through between scans: its camera's frames, with the laser lit (set_laser() of any
/// power above 0) or off, and its camera's settings.
void offer_view(dubsar_driver& driver);

}  // namespace dubsar
