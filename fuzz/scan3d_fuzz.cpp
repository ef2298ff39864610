// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a GenICam range camera says of its samples, and the samples: values of its features first, then a
// frame.
#include <cstring>

#include "drivers/aravis/options.h"
#include "drivers/aravis/scan3d.h"
#include "fuzz/fuzz_support.h"

using namespace dubsar::aravis;

namespace {

/// Takes values off the front of the input; zeros behind its end.
class Values {
 public:
  explicit Values(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  template <class T>
  T next() {
    T value{};
    const std::size_t count = std::min(sizeof value, bytes_.size());
    std::memcpy(&value, bytes_.data(), count);
    bytes_ = bytes_.subspan(count);
    return value;
  }
  [[nodiscard]] std::span<const std::uint8_t> rest() const { return bytes_; }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Values values(std::span(data, size));
  Scan3d meaning;
  const auto formats = range_formats();
  meaning.format = formats[values.next<std::uint8_t>() % formats.size()];
  meaning.width = values.next<std::uint16_t>();
  meaning.height = values.next<std::uint16_t>();
  meaning.flip_z = (values.next<std::uint8_t>() & 1U) != 0;
  meaning.unit_mm = values.next<double>();
  for (AxisScale& axis : meaning.axes) {
    axis.scale = values.next<double>();
    axis.offset = values.next<double>();
    if ((values.next<std::uint8_t>() & 1U) != 0) {
      axis.invalid = values.next<double>();
    }
  }
  const std::span<const std::uint8_t> frame = values.rest();
  if (check(meaning, "camera") &&
      frame.size() >= std::size_t{meaning.width} * meaning.height * meaning.format.sample_bytes()) {
    ProfileRow row;
    for (std::uint32_t r = 0; r < meaning.height; ++r) {
      read_row(meaning, frame, r, 0.1 * r, row);
      dubsar::fuzz::require(row.valid.size() == meaning.width && row.z.size() == meaning.width);
      for (std::size_t i = 0; i < row.valid.size(); ++i) {
        dubsar::fuzz::require(row.valid[i] == 0 || (std::isfinite(row.x[i]) && std::isfinite(row.y[i]) &&
                                                    std::isfinite(row.z[i])));
      }
    }
  }
  // Its options, as text: KEY=VALUE in the same bytes.
  const std::string text(dubsar::fuzz::text_of(data, size).substr(0, 256));
  const std::string safe = text.substr(0, text.find('\0'));
  const std::size_t equals = std::min(safe.find('='), safe.size());
  const std::string key = safe.substr(0, equals);
  const std::string value = equals < safe.size() ? safe.substr(equals + 1) : std::string();
  const dubsar_option option{key.c_str(), value.c_str()};
  (void)parse_options(std::span(&option, 1));
  return 0;
}
