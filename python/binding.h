// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh.h"
#include "core/range_grid.h"
#include "core/result.h"
#include "core/rigid_transform.h"
#include "core/wedge.h"

namespace dubsar::python {

namespace py = pybind11;

/// Raises the Python exception of an error: UsageError, BadInputError, DeviceError, StorageError, Cancelled
/// or InternalError, all of them dubsar.Error.
[[noreturn]] void raise(const Error& error);

/// Warns the caller of a scan (dubsar.ScanWarning); raises where warnings are errors to them.
void warn_of_scan(const std::string& line);
/// The same of a mesh (dubsar.MeshWarning).
void warn_of_mesh(const std::string& line);

template <class T>
T value_of(Result<T> result) {
  if (!result) {
    raise(result.error());
  }
  if constexpr (!std::is_void_v<T>) {
    return std::move(*result);
  }
}

/// C-contiguous input, converted where it has to be.
template <class T>
using Input = py::array_t<T, py::array::c_style | py::array::forcecast>;

/// numpy's view of memory that lives as long as `owner`; nothing is copied.
template <class T>
py::array_t<T> view_of(const T* data, std::vector<py::ssize_t> shape, const py::object& owner) {
  return py::array_t<T>(std::move(shape), data, owner);
}

/// [4, 4], target_from_source.
py::array_t<double> matrix_of(const RigidTransform& transform);
/// What the file's numbers are (kLengthUnits); raises UsageError for anything else.
std::optional<double> mm_per_unit_named(const std::optional<std::string>& unit);

/// A structured array of wedges; the columns are in wedge_rows.cpp and the type stubs.
py::array wedge_rows(const std::vector<Wedge>& wedges);
/// Tells numpy of the columns; once, before the first wedge_rows().
void bind_wedge_rows();

/// Raises UsageError where a file would lie in a session or a package, as no verb writes there.
void check_may_write(const std::filesystem::path& path);

/// Raises UsageError where a face names no vertex, or a place is not finite: the arrays are open to writing.
void check_sound(const Mesh& mesh);

using GridPointer = std::shared_ptr<RangeGrid>;

void bind_errors(py::module_& module);
void bind_grids(py::module_& module);
void bind_meshes(py::module_& module);
void bind_scans(py::module_& module);
void bind_analysis(py::module_& module);
void bind_simulation(py::module_& module);

}  // namespace dubsar::python
