// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/loader.h"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <sstream>

#include "drivers/abi.h"
#include "drivers/driver.h"
#include "drivers/driver_call.h"
#include "drivers/trust.h"

namespace dubsar {

namespace fs = std::filesystem;

namespace {

/// Up to the last member of version 1; later members are optional.
constexpr std::size_t kLeastDriverSize = offsetof(dubsar_driver, scan) + sizeof(dubsar_driver::scan);

std::unexpected<Error> reject(const fs::path& path, std::string what, std::string mend = "skipped") {
  return fail(ErrorKind::kDevice, std::move(what), path.string(), std::move(mend));
}

bool is_scheme(const std::string& scheme) {
  return !scheme.empty() && scheme[0] >= 'a' && scheme[0] <= 'z' && std::ranges::all_of(scheme, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

/// Whether a driver has all functions of a group, or none.
template <class... Members>
bool whole(const dubsar_driver* driver, Members... members) {
  const std::size_t there = (std::size_t{0} + ... + (abi::offered(driver, members) != nullptr ? 1 : 0));
  return there == 0 || there == sizeof...(members);
}

Result<const dubsar_driver*> entry_of(void* library, const fs::path& path) {
  void* symbol = ::dlsym(library, DUBSAR_DRIVER_ENTRY);
  if (symbol == nullptr) {
    return reject(path, "not a Dubsar driver: no " DUBSAR_DRIVER_ENTRY " in it");
  }
  using Entry = const dubsar_driver* (*)();
  const dubsar_driver* driver = reinterpret_cast<Entry>(symbol)();
  if (driver == nullptr) {
    return reject(path, "the driver says that it cannot work here");
  }
  if (driver->abi_version != DUBSAR_DRIVER_ABI_VERSION) {
    return reject(path,
                  "driver interface version " + std::to_string(driver->abi_version) + ", this program has " +
                      std::to_string(DUBSAR_DRIVER_ABI_VERSION),
                  driver->abi_version < DUBSAR_DRIVER_ABI_VERSION ? "skipped; get a newer driver"
                                                                  : "skipped; get a newer Dubsar");
  }
  if (driver->struct_size < kLeastDriverSize) {
    return reject(path, "its driver struct has " + std::to_string(driver->struct_size) +
                            " bytes of at least " + std::to_string(kLeastDriverSize));
  }
  if (driver->describe_options == nullptr || driver->discover == nullptr || driver->open == nullptr ||
      driver->close == nullptr || driver->capabilities == nullptr || driver->scan == nullptr) {
    return reject(path, "the driver lacks a function that every driver has");
  }
  if (!whole(driver, &dubsar_driver::describe_settings, &dubsar_driver::get_setting,
             &dubsar_driver::set_setting)) {
    return reject(path, "the driver has some of the settings functions and not all");
  }
  if (!whole(driver, &dubsar_driver::start_frames, &dubsar_driver::next_frame, &dubsar_driver::release_frame,
             &dubsar_driver::stop_frames, &dubsar_driver::frame_counters)) {
    return reject(path, "the driver has some of the functions of a camera and not all");
  }
  if (!whole(driver, &dubsar_driver::describe_axes, &dubsar_driver::home, &dubsar_driver::move,
             &dubsar_driver::read_motion, &dubsar_driver::set_laser, &dubsar_driver::emergency_stop)) {
    return reject(path, "the driver has some of the functions of a stage and not all");
  }
  if (!is_scheme(abi::text(driver->scheme))) {
    return reject(path, "the driver's scheme is no scheme");
  }
  return driver;
}

Result<const dubsar_driver*> load(const fs::path& path) {
  const Result<fs::path> trusted = trusted_file(path, ::geteuid());
  if (!trusted) {
    return std::unexpected(trusted.error());
  }
  const DriverCall call(path.string());
  // Symbols stay to themselves, and a missing one shows now rather than in the middle of a scan.
  void* library = ::dlopen(trusted->c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    std::string why = abi::text(::dlerror());
    if (why.starts_with(path.string() + ": ")) {
      why.erase(0, path.string().size() + 2);
    }
    return reject(path, "cannot be loaded: " + why);
  }
  Result<const dubsar_driver*> driver = entry_of(library, path);
  if (!driver) {
    ::dlclose(library);
  }
  return driver;  // The handle of an accepted driver is kept open on purpose.
}

}  // namespace

Driver::Driver(const dubsar_driver* abi, fs::path path)
    : abi_(abi),
      path_(std::move(path)),
      scheme_(abi::text(abi->scheme)),
      description_(abi::text(abi->description)),
      version_(abi::text(abi->version)),
      locator_help_(abi::text(abi->locator_help)) {}

Result<std::vector<SettingInfo>> Driver::options() const {
  std::vector<SettingInfo> out;
  auto error = abi::lent<dubsar_error>();
  const auto collect = [](void* user, const dubsar_setting* setting) noexcept -> std::int32_t {
    static_cast<std::vector<SettingInfo>*>(user)->push_back(abi::setting_from(abi::taken(setting)));
    return 0;
  };
  const DriverCall call(scheme_);
  if (const std::int32_t code = abi_->describe_options(collect, &out, &error); code != DUBSAR_OK) {
    return std::unexpected(abi::error_from(code, error, scheme_));
  }
  return out;
}

Result<std::vector<FoundDevice>> Driver::discover() const {
  std::vector<FoundDevice> out;
  auto error = abi::lent<dubsar_error>();
  const auto collect = [](void* user, const dubsar_device_info* info) noexcept -> std::int32_t {
    const dubsar_device_info taken = abi::taken(info);
    static_cast<std::vector<FoundDevice>*>(user)->push_back(
        {abi::text(taken.uri), abi::text(taken.description)});
    return 0;
  };
  const DriverCall call(scheme_);
  if (const std::int32_t code = abi_->discover(collect, &out, &error); code != DUBSAR_OK) {
    return std::unexpected(abi::error_from(code, error, scheme_));
  }
  return out;
}

Result<Device> Driver::open(const std::string& locator,
                            const std::vector<std::pair<std::string, std::string>>& options) const {
  const Result<std::vector<SettingInfo>> known = this->options();
  if (!known) {
    return std::unexpected(known.error());
  }
  const std::string uri = scheme_ + ":" + locator;
  std::vector<dubsar_option> passed;
  for (const auto& [key, value] : options) {
    if (std::ranges::find(*known, key, &SettingInfo::key) == known->end()) {
      const std::string keys = abi::listed(*known, &SettingInfo::key);
      return fail(ErrorKind::kUsage, "no option " + key, uri,
                  keys.empty() ? scheme_ + ": takes no options" : scheme_ + ": takes " + keys);
    }
    passed.push_back({key.c_str(), value.c_str()});
  }
  dubsar_device* device = nullptr;
  auto error = abi::lent<dubsar_error>();
  const std::int32_t code = [&] {
    const DriverCall call(uri);
    return abi_->open(locator.c_str(), passed.data(), static_cast<std::uint32_t>(passed.size()), &device,
                      &error);
  }();
  if (code != DUBSAR_OK) {
    return std::unexpected(abi::error_from(code, error, uri));
  }
  if (device == nullptr) {
    return fail(ErrorKind::kDevice, "the driver opened nothing", uri, "update the driver");
  }
  return Device(abi_, device, uri);
}

DriverRegistry::DriverRegistry(const std::vector<fs::path>& search_path) : search_path_(search_path) {
  std::vector<fs::path> seen;
  for (const fs::path& folder : search_path_) {
    std::error_code ignored;
    const fs::path real = fs::canonical(folder, ignored);
    if (ignored || std::ranges::find(seen, real) != seen.end()) {
      continue;
    }
    seen.push_back(real);
    std::vector<fs::path> files;
    for (fs::directory_iterator it(real, ignored), end; !ignored && it != end; it.increment(ignored)) {
      if (it->path().extension() == ".so") {
        files.push_back(it->path());
      }
    }
    std::ranges::sort(files);
    for (const fs::path& file : files) {
      const Result<const dubsar_driver*> driver = load(file);
      if (!driver) {
        rejected_.push_back(driver.error());
        continue;
      }
      const auto same = std::ranges::find(drivers_, abi::text((*driver)->scheme), &Driver::scheme);
      if (same != drivers_.end()) {
        rejected_.push_back(reject(file, "a driver for " + same->scheme() + ": is there already, from " +
                                             same->path().string())
                                .error());
        continue;
      }
      drivers_.emplace_back(*driver, file);
    }
  }
  std::ranges::sort(drivers_, {}, &Driver::scheme);
}

std::vector<fs::path> DriverRegistry::default_search_path() {
  std::vector<fs::path> out;
  // Not where the program runs with more rights than who started it.
  if (const char* listed = ::secure_getenv("DUBSAR_DRIVER_PATH")) {
    std::istringstream folders(listed);
    for (std::string folder; std::getline(folders, folder, ':');) {
      if (!folder.empty()) {
        out.emplace_back(folder);
      }
    }
  }
  std::error_code ignored;
  const fs::path executable = fs::read_symlink("/proc/self/exe", ignored);
  if (!ignored) {
    out.push_back(executable.parent_path().parent_path() / "lib/dubsar/drivers");
  }
  if (const char* data = std::getenv("XDG_DATA_HOME"); data != nullptr && *data != '\0') {
    out.push_back(fs::path(data) / "dubsar/drivers");
  } else if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0') {
    out.push_back(fs::path(home) / ".local/share/dubsar/drivers");
  }
  return out;
}

Result<const Driver*> DriverRegistry::find(const std::string& scheme) const {
  const auto driver = std::ranges::find(drivers_, scheme, &Driver::scheme);
  if (driver != drivers_.end()) {
    return &*driver;
  }
  const std::string schemes = abi::listed(drivers_, [](const Driver& one) { return one.scheme() + ":"; });
  if (schemes.empty()) {
    const std::string where =
        abi::listed(search_path_, [](const fs::path& folder) { return folder.string(); });
    return fail(ErrorKind::kUsage, "no driver for " + scheme + ":", {},
                "no driver was found in " + where + "; set DUBSAR_DRIVER_PATH");
  }
  return fail(ErrorKind::kUsage, "no driver for " + scheme + ":", {}, "there are " + schemes);
}

}  // namespace dubsar
