// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/unit_name.h"

#include <array>
#include <string>
#include <utility>

#include "core/lower_case.h"
#include "core/units.h"

namespace dubsar {

std::optional<double> mm_per_unit_as_written(std::string_view word) {
  // µ is the sign of Latin-1, the same in UTF-8, or the Greek letter.
  constexpr std::array<std::pair<std::string_view, std::string_view>, 13> kNames{{
      {"meter", "m"},
      {"metre", "m"},
      {"centimeter", "cm"},
      {"centimetre", "cm"},
      {"millimeter", "mm"},
      {"millimetre", "mm"},
      {"micrometer", "um"},
      {"micrometre", "um"},
      {"micron", "um"},
      {"\xB5m", "um"},
      {"\xC2\xB5m", "um"},
      {"\xCE\xBCm", "um"},
      {"inch", "in"},
  }};
  std::string name = in_lower_case(std::string(word));
  if (name == "inches") {
    name = "inch";
  } else if (name.size() > 4 && name.ends_with('s')) {
    name.pop_back();
  }
  for (const auto& [known, unit] : kNames) {
    if (name == known) {
      return mm_per_unit(unit);
    }
  }
  return mm_per_unit(name);
}

}  // namespace dubsar
