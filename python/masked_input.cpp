// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "python/masked_input.h"

#include <algorithm>

namespace dubsar::python {

std::optional<Input<bool>> mask_of(py::handle given, const std::string& name) {
  if (!py::isinstance<py::array>(given) || !py::hasattr(given, "mask")) {
    return std::nullopt;
  }
  const auto array = py::reinterpret_borrow<py::array>(given);
  auto mask = Input<bool>::ensure(given.attr("mask"));
  if (!mask) {
    PyErr_Clear();
  } else if (mask.ndim() == 0) {  // numpy.ma.nomask, or all of it
    if (!*mask.data()) {
      return std::nullopt;
    }
    mask = Input<bool>::ensure(py::module_::import("numpy").attr("ones_like")(
        given, py::arg("dtype") = "bool", py::arg("subok") = false));
  }
  if (!mask || mask.ndim() != array.ndim() ||
      !std::equal(mask.shape(), mask.shape() + mask.ndim(), array.shape())) {
    raise({ErrorKind::kUsage, name + " has a mask of another shape", {}, "fill it first"});
  }
  const bool* const masked = mask.data();
  return std::any_of(masked, masked + mask.size(), [](bool hidden) { return hidden; })
             ? std::optional<Input<bool>>(mask)
             : std::nullopt;
}

void check_unmasked(py::handle given, const std::string& name) {
  if (mask_of(given, name)) {
    raise({ErrorKind::kUsage, name + " has masked values", {}, "fill them, or take them out"});
  }
}

}  // namespace dubsar::python
