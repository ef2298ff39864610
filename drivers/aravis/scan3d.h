// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"

/// What a range camera's numbers mean (GenICam SFNC 2.7, 3D Scan Control; PFNC 2.4, Coord3D formats). Pure.
namespace dubsar::aravis {

/// A Coord3D pixel format: which of the axes A, B and C it has, and how they lie.
struct RangeFormat {
  std::uint32_t code = 0;
  const char* name = "";
  std::array<bool, 3> has{};
  std::uint32_t bytes = 2;  ///< of one coordinate: 1, 2 (unsigned) or 4 (float)
  bool planar = false;      ///< all A of the frame, then all C; else A and C of each sample beside each other

  [[nodiscard]] std::uint32_t coordinates() const { return has[0] + has[1] + has[2]; }
  [[nodiscard]] std::uint32_t sample_bytes() const { return bytes * coordinates(); }
};

/// The formats that can be read, best first: those that bring x along before those that do not.
[[nodiscard]] std::span<const RangeFormat> range_formats();
[[nodiscard]] const RangeFormat* range_format(std::uint32_t code);
[[nodiscard]] const RangeFormat* range_format(const std::string& name);

/// Of one axis: coordinate = scale * number + offset, in the camera's distance unit.
struct AxisScale {
  double scale = 1;
  double offset = 0;
  std::optional<double> invalid;  ///< the number that stands for "no return"
  bool told = false;              ///< the scale is the camera's word
};

struct Scan3d {
  std::array<AxisScale, 3> axes;
  double unit_mm = 1;   ///< of the distance unit
  bool flip_z = false;  ///< C grows away from the scanner
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  RangeFormat format;
};

/// kBadInput: scales, offsets or sizes that cannot be. where names the camera.
Status check(const Scan3d& meaning, const std::string& where);

/// kUsage: neither the data nor the camera's scales say how far apart columns or rows lie; of rows `row_mm`
/// does as well, where it is not 0.
Status check_places(const Scan3d& meaning, double row_mm, const std::string& where);

/// One row of a frame as a profile in the scanner frame, mm.
struct ProfileRow {
  std::vector<float> x, y, z;
  std::vector<std::uint8_t> valid;
};

/// Fills a row of `out` from a frame of meaning.height rows. y is y_mm where the format has no B. A sample
/// whose C (or A or B) is invalid, or no finite number, is invalid. \pre row < height, frame.size() >= width
/// * height * sample_bytes().
void read_row(const Scan3d& meaning, std::span<const std::uint8_t> frame, std::uint32_t row, double y_mm,
              ProfileRow& out);

}  // namespace dubsar::aravis
