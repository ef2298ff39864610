// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>

#include "python/binding.h"

namespace dubsar::python {

/// The mask of numpy's masked arrays and of those of others that have one (astropy): true where there is no
/// value, of the array's own shape. Nothing for what has none, or one that hides nothing. Raises UsageError
/// where it has another shape.
std::optional<Input<bool>> mask_of(py::handle given, const std::string& name);

/// Raises UsageError where something of it is masked: behind a mask lies any number.
void check_unmasked(py::handle given, const std::string& name);

/// An argument as numbers, with its mask.
template <class T>
struct MaskedInput {
  Input<T> values;
  py::object given;
  [[nodiscard]] std::optional<Input<bool>> mask(const char* name) const { return mask_of(given, name); }
};

/// Raises UsageError when it is no [4, 4] rigid transform.
RigidTransform transform_of(const MaskedInput<double>& matrix, const std::string& what);

}  // namespace dubsar::python

namespace pybind11::detail {

/// What is no array of numbers is refused as for Input.
template <class T>
struct type_caster<dubsar::python::MaskedInput<T>> {
  using Values = make_caster<dubsar::python::Input<T>>;
  PYBIND11_TYPE_CASTER(dubsar::python::MaskedInput<T>, Values::name);
  bool load(handle source, bool convert) {
    Values values;
    if (!values.load(source, convert)) {
      return false;
    }
    value.values = cast_op<dubsar::python::Input<T>>(values);
    value.given = reinterpret_borrow<object>(source);
    return true;
  }
};

}  // namespace pybind11::detail
