// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Errors as Python exceptions that keep what, where and mend apart.

#include <array>

#include "python/binding.h"
#include "python/file_text.h"
#include "station/place_outside.h"

namespace dubsar::python {

namespace {

struct Kind {
  ErrorKind kind;
  const char* name;
  PyObject* base;  ///< Python's own exception that it also is, so that callers need not know ours
  const char* help;
  PyObject* type = nullptr;
};

// The interpreter keeps the types as long as it runs; the module is never unloaded.
std::array<Kind, 6>& kinds() {
  static std::array<Kind, 6> all{{
      {ErrorKind::kUsage, "UsageError", PyExc_ValueError, "What was asked for does not exist."},
      {ErrorKind::kBadInput, "BadInputError", PyExc_ValueError,
       "Outside bytes are not what they claim to be."},
      {ErrorKind::kDevice, "DeviceError", PyExc_OSError, "A device or its driver failed."},
      {ErrorKind::kStorage, "StorageError", PyExc_OSError, "The disk refused."},
      {ErrorKind::kCancelled, "Cancelled", nullptr, "progress() returned False."},
      {ErrorKind::kInternal, "InternalError", PyExc_RuntimeError, "A defect of Dubsar: please report it."},
  }};
  return all;
}

// Likewise kept as long as the interpreter runs.
PyObject* scan_warning = nullptr;
PyObject* mesh_warning = nullptr;

void warn(PyObject* category, const std::string& line) {
  if (PyErr_WarnFormat(category, 1, "%U", text_of(line).ptr()) != 0) {
    throw py::error_already_set();
  }
}

/// A UserWarning of the module.
PyObject* add_warning(py::module_& module, const char* name, const char* help) {
  const std::string full = std::string("dubsar.") + name;
  PyObject* const type = PyErr_NewExceptionWithDoc(full.c_str(), help, PyExc_UserWarning, nullptr);
  if (type == nullptr) {
    throw py::error_already_set();
  }
  module.attr(name) = py::reinterpret_borrow<py::object>(type);
  return type;
}

}  // namespace

py::str text_of(const std::string& bytes) {
  PyObject* const text =
      PyUnicode_DecodeFSDefaultAndSize(bytes.data(), static_cast<py::ssize_t>(bytes.size()));
  if (text == nullptr) {
    throw py::error_already_set();
  }
  return py::reinterpret_steal<py::str>(text);
}

std::string bytes_of(const py::str& text) {
  PyObject* const bytes = PyUnicode_EncodeFSDefault(text.ptr());
  if (bytes == nullptr) {
    throw py::error_already_set();
  }
  return std::string(py::reinterpret_steal<py::bytes>(bytes));
}

void warn_of_scan(const std::string& line) {
  warn(scan_warning, line);
}

void warn_of_mesh(const std::string& line) {
  warn(mesh_warning, line);
}

void raise(const Error& error) {
  for (const Kind& kind : kinds()) {
    if (kind.kind == error.kind) {
      const py::object type = py::reinterpret_borrow<py::object>(kind.type);
      const py::object exception = type(text_of(error.line()));
      exception.attr("what") = text_of(error.what);
      exception.attr("where") = text_of(error.where);
      exception.attr("mend") = text_of(error.mend);
      PyErr_SetObject(kind.type, exception.ptr());
      throw py::error_already_set();
    }
  }
  throw std::logic_error(error.line());
}

void check_may_write(const std::filesystem::path& path) {
  value_of(check_outside_checked_folders(path));
}

void bind_errors(py::module_& module) {
  py::object base = py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc(
      "dubsar.Error", "What went wrong, where, and the mend: the attributes `what`, `where` and `mend`.",
      PyExc_Exception, nullptr));
  for (const char* name : {"what", "where", "mend"}) {
    base.attr(name) = "";
  }
  module.attr("Error") = base;
  for (Kind& kind : kinds()) {
    py::tuple bases = kind.base == nullptr
                          ? py::make_tuple(base)
                          : py::make_tuple(base, py::reinterpret_borrow<py::object>(kind.base));
    const std::string name = std::string("dubsar.") + kind.name;
    kind.type = PyErr_NewExceptionWithDoc(name.c_str(), kind.help, bases.ptr(), nullptr);
    if (kind.type == nullptr) {
      throw py::error_already_set();
    }
    module.attr(kind.name) = py::reinterpret_borrow<py::object>(kind.type);
  }
  scan_warning =
      add_warning(module, "ScanWarning", "A scan was read otherwise than its file says, or is doubtful.");
  mesh_warning = add_warning(module, "MeshWarning", "A mesh is measured, but hardly what was meant.");
}

}  // namespace dubsar::python
