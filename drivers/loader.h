// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "drivers/device.h"

namespace dubsar {

/// A device that a driver found.
struct FoundDevice {
  std::string uri;
  std::string description;
};

/// A driver plugin that was loaded and accepted.
class Driver {
 public:
  Driver(const dubsar_driver* abi, std::filesystem::path path);

  [[nodiscard]] const std::string& scheme() const { return scheme_; }
  [[nodiscard]] const std::string& description() const { return description_; }
  [[nodiscard]] const std::string& version() const { return version_; }
  /// What stands between the colon and '?' of its URIs, for people; may be empty.
  [[nodiscard]] const std::string& locator_help() const { return locator_help_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] Result<std::vector<SettingInfo>> options() const;
  [[nodiscard]] Result<std::vector<FoundDevice>> discover() const;

  /// Opens a device. An option that the driver does not know is refused with a line that names those it does.
  [[nodiscard]] Result<Device> open(const std::string& locator,
                                    const std::vector<std::pair<std::string, std::string>>& options) const;

 private:
  const dubsar_driver* abi_;
  std::filesystem::path path_;
  std::string scheme_, description_, version_, locator_help_;
};

/// The drivers that were found on a search path. A library that is broken, too old or too new, no driver at
/// all, or that others can have put there or can change (drivers/trust.h) is left out with one line in
/// rejected(). A driver stays loaded until the process ends: drivers may leave threads behind, and code under
/// a thread must not be unmapped.
class DriverRegistry {
 public:
  /// Loads every *.so of the folders, in name order; folders that do not exist are skipped. Of two drivers
  /// with the same scheme the first wins and the second is rejected.
  explicit DriverRegistry(const std::vector<std::filesystem::path>& search_path = default_search_path());

  /// In this order: the folders of $DUBSAR_DRIVER_PATH (parted by ':'), lib/dubsar/drivers beside the folder
  /// of the executable (an installation or a build), and dubsar/drivers in $XDG_DATA_HOME or ~/.local/share.
  [[nodiscard]] static std::vector<std::filesystem::path> default_search_path();

  [[nodiscard]] const std::vector<Driver>& drivers() const { return drivers_; }  ///< by scheme
  [[nodiscard]] const std::vector<Error>& rejected() const { return rejected_; }
  [[nodiscard]] const std::vector<std::filesystem::path>& search_path() const { return search_path_; }

  /// kUsage with the schemes that there are when there is none such. The driver lives as long as the
  /// registry.
  [[nodiscard]] Result<const Driver*> find(const std::string& scheme) const;

 private:
  std::vector<std::filesystem::path> search_path_;
  std::vector<Driver> drivers_;
  std::vector<Error> rejected_;
};

}  // namespace dubsar
