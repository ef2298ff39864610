// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The extension module behind the Python package `dubsar`.

#include "core/log.h"
#include "python/binding.h"

PYBIND11_MODULE(_dubsar, module) {
  namespace python = dubsar::python;
  module.attr("__version__") = DUBSAR_VERSION;
  // A library does not talk unless something is wrong.
  dubsar::set_log_level(dubsar::LogLevel::kWarning);
  python::bind_errors(module);
  python::bind_wedge_rows();
  python::bind_grids(module);
  python::bind_meshes(module);
  python::bind_scans(module);
  python::bind_analysis(module);
  python::bind_simulation(module);
}
