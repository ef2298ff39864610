// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "drivers/driver.h"
#include "drivers/v4l2/controls.h"
#include "drivers/v4l2/modes.h"
#include "drivers/v4l2/node.h"
#include "drivers/v4l2/region.h"
#include "drivers/v4l2/stream.h"

namespace dubsar::v4l2 {

struct CameraOptions {
  Wish wish;
  std::uint32_t buffers = 0;  ///< 0: as many as half a second takes, see pool_depth()
};

/// A camera that is used from open to close, plugged in or not: settings and counts outlive a lost cable.
class Camera {
 public:
  [[nodiscard]] static Result<std::unique_ptr<Camera>> open(const std::string& path,
                                                            const CameraOptions& options);

  [[nodiscard]] const std::string& model() const { return card_; }
  [[nodiscard]] const std::string& serial() const { return serial_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// What it sends: of the region, at the rate that it told.
  [[nodiscard]] const Mode& mode() const { return mode_; }
  /// What a region can be chosen from; nothing where the camera sends its whole picture or none.
  [[nodiscard]] const std::optional<Region>& whole() const { return whole_; }
  [[nodiscard]] Region region() const;
  /// Both kUsage while frames run, and where the camera makes something else of it; then all is as before.
  Status set_region(const Region& wanted);
  Status set_rate(double rate_hz);
  [[nodiscard]] const std::vector<Control>& controls() const { return controls_; }

  [[nodiscard]] Result<dubsar_value> get(const Control& control) const;
  Status set(const Control& control, const dubsar_value& value);

  Status start(std::uint32_t pool);
  [[nodiscard]] Result<std::optional<dubsar_frame>> next(Stream::Clock::time_point until);
  void give_back(std::uint64_t lease);
  void stop();
  [[nodiscard]] dubsar_frame_counters counters() const;

 private:
  Camera() = default;
  Status configure();
  Status put_format(std::uint32_t width, std::uint32_t height);
  Status put_region_and_format(const Region& region);
  void put_rate(double rate_hz);
  [[nodiscard]] double wanted_rate_hz() const;
  [[nodiscard]] Status may_change(const char* what) const;
  Status find_again();
  void end_stream();

  std::string path_, card_, bus_, serial_;
  CameraOptions options_;
  std::unique_ptr<Node> node_;  ///< none while the camera is gone
  Mode chosen_;                 ///< of those that it lists
  Mode mode_;
  std::optional<Region> whole_;
  Region region_;                  ///< of no size: the whole picture
  std::optional<double> rate_hz_;  ///< that was set
  std::uint32_t stride_ = 0;
  bool limited_range_ = false;
  std::vector<Control> controls_;
  std::map<std::uint32_t, dubsar_value> set_here_;  ///< by control; set again after the camera was gone

  mutable std::mutex mutex_;                                ///< of what give_back() and counters() look at
  std::uint32_t generation_ = 0;                            ///< of the stream
  std::shared_ptr<Stream> stream_;                          ///< the one that runs
  std::map<std::uint32_t, std::shared_ptr<Stream>> ended_;  ///< of which frames are still lent
  Counts past_;
  std::uint32_t pool_ = 0;
  std::uint64_t reconnections_ = 0;
};

/// The cameras of a folder of device files (/dev): path and name, in order of their numbers. Those in use are
/// among them, and those that this user has no right to, with how to get it in place of the name.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> find_cameras(
    const std::filesystem::path& folder);

}  // namespace dubsar::v4l2
