// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The wedges of a mesh.

#include "station/analysis.h"

#include <fmt/format.h>

#include "analysis/tablet_size.h"
#include "core/inside_out.h"
#include "formats/wedges_json.h"
#include "python/file_text.h"
#include "python/jobs.h"
#include "station/outward_faces.h"
#include "station/wedge_doubts.h"

namespace dubsar::python {

namespace fs = std::filesystem;

namespace {

/// What analyze() gives, and what wedges.json holds of it.
struct Wedges {
  WedgeFile file;
  std::shared_ptr<const Mesh> mesh;          ///< null when it was read from a file
  std::shared_ptr<const Analysis> analysis;  ///< likewise
};
using WedgesPointer = std::shared_ptr<Wedges>;

/// Makes of a mesh what `dubsar analyze` measures, and gives what to warn of. What the command refuses until
/// --unit settles it is doubted only: arrays are millimetres by contract.
Result<std::vector<std::string>> make_measurable(std::shared_ptr<const Mesh>& mesh, const std::string& name) {
  std::vector<std::string> doubts;
  const Status measurable = check_measurable(*mesh, name);
  const double across_mm = size_across_mm(*mesh);
  if (const auto likelier = likelier_units(across_mm, 1.0); !likelier.empty()) {
    const Error doubt{ErrorKind::kBadInput, fmt::format("it would be {:.3g} mm across", across_mm), name,
                      fmt::format("its numbers look like {}: give millimetres", fmt::join(likelier, " or "))};
    if (!measurable) {
      return std::unexpected(doubt);  // micrometres look as if they were far from their origin
    }
    doubts.push_back(doubt.line());
  }
  if (!measurable) {
    return std::unexpected(measurable.error());
  }
  if (const std::optional<Error> fault = inside_out(*mesh, name)) {
    doubts.push_back(fault->line());
    auto turned = std::make_shared<Mesh>(*mesh);
    turn_over(turned.get());
    mesh = std::move(turned);
  }
  return doubts;
}

void warn_of_doubts(const std::vector<Error>& doubts) {
  for (const Error& doubt : doubts) {
    warn_of_mesh(doubt.line());
  }
}

WedgesPointer analyze(const std::shared_ptr<Mesh>& mesh, const std::string& exit, const py::str& name_text,
                      const py::object& progress) {
  const std::string name = bytes_of(name_text);
  AnalysisOptions options;
  if (exit != "surface" && exit != "extent") {
    raise({ErrorKind::kUsage, "no exit " + exit, {}, "there are surface and extent"});
  }
  options.wedges.exits = exit == "extent" ? ExitDefinition::kExtent : ExitDefinition::kSurface;
  check_sound(*mesh);
  std::shared_ptr<const Mesh> measured = mesh;
  const std::vector<std::string> doubts =
      run_for_result(py::none(), [&](JobContext&) { return make_measurable(measured, name); });
  for (const std::string& doubt : doubts) {
    warn_of_mesh(doubt);
  }
  Analysis analysis =
      run_for_result(progress, [&](JobContext& job) { return analyze_mesh(*measured, options, job); });
  auto out = std::make_shared<Wedges>();
  out->file = wedge_file(name, options, analysis);
  warn_of_doubts(doubts_of(out->file, name, analysis.fields.body_count()));
  out->mesh = std::move(measured);
  out->analysis = std::make_shared<const Analysis>(std::move(analysis));
  return out;
}

py::list rejected_of(const Wedges& wedges) {
  py::list out;
  for (const RejectedWedge& one : wedges.file.rejected) {
    py::dict entry;
    entry["reason"] = one.reason;
    entry["depth_point_mm"] =
        py::make_tuple(one.depth_point_mm.x(), one.depth_point_mm.y(), one.depth_point_mm.z());
    out.append(entry);
  }
  return out;
}

py::dict fields_of(const WedgesPointer& wedges) {
  py::dict out;
  if (!wedges->analysis) {
    return out;
  }
  const SurfaceFields& fields = wedges->analysis->fields;
  const py::object owner = py::cast(wedges);
  const auto put = [&](const char* name, const auto& values) {
    out[name] = view_of(values.data(), {static_cast<py::ssize_t>(values.size())}, owner);
  };
  put("reliability", fields.reliability);
  put("mean_curvature_per_mm", fields.mean_curvature_per_mm);
  put("gaussian_curvature_per_mm2", fields.gaussian_curvature_per_mm2);
  put("openness", fields.openness);
  put("height_mm", fields.height_mm);
  out["free_surface"] =
      py::array(py::dtype::of<bool>(), {static_cast<py::ssize_t>(fields.free_surface.size())},
                fields.free_surface.data(), owner);
  return out;
}

std::shared_ptr<Mesh> annotated(const Wedges& wedges) {
  if (!wedges.analysis) {
    raise({ErrorKind::kUsage, "these wedges were read from a file", {}, "analyze the mesh"});
  }
  auto out = std::make_shared<Mesh>();
  run_job(py::none(), [&](JobContext&) { *out = annotated_mesh(*wedges.mesh, *wedges.analysis); });
  return out;
}

}  // namespace

void bind_analysis(py::module_& module) {
  py::class_<Wedges, WedgesPointer>(module, "Wedges", "The wedges of one mesh.")
      .def_property_readonly(
          "table", [](const Wedges& w) { return wedge_rows(w.file.wedges); },
          "a structured array, one row a wedge; a copy")
      .def_property_readonly("rejected", &rejected_of, "hollows that are no wedges, each with the reason")
      .def_property_readonly("fields", &fields_of,
                             "[V] arrays of the mesh's vertices by name; empty when read from a file")
      .def_property_readonly(
          "text_from_model",
          [](const Wedges& w) -> py::object {
            return w.file.text_from_model ? py::object(matrix_of(*w.file.text_from_model)) : py::none();
          },
          "[4, 4]: x to the reader's right, y up the obverse, z out of it; or None")
      .def_property_readonly(
          "text_certainty", [](const Wedges& w) { return w.file.text_certainty; },
          "0 to 1: how clearly the wedges show a direction of writing; below 0.1 they may be none")
      .def_property_readonly("timings_s",
                             [](const Wedges& w) {
                               py::dict out;
                               for (const auto& [stage, seconds] : w.file.timings_s) {
                                 out[py::str(stage)] = seconds;
                               }
                               return out;
                             })
      .def("annotated_mesh", &annotated, "the mesh with each wedge in a colour of its own")
      .def(
          "to_json", [](const Wedges& w) { return wedges_to_json(w.file); }, "what wedges.json holds")
      .def(
          "write",
          [](const Wedges& w, const fs::path& path) {
            check_may_write(path);
            value_of(write_wedges(path, w.file));
          },
          py::arg("path"), "wedges.json; whole or not at all")
      .def("__len__", [](const Wedges& w) { return w.file.wedges.size(); })
      .def("__repr__", [](const Wedges& w) {
        return "<dubsar.Wedges " + std::to_string(w.file.wedges.size()) + " wedges, " +
               std::to_string(w.file.rejected.size()) + " rejected>";
      });
  module.def("analyze", &analyze, py::arg("mesh").none(false), py::arg("exit") = "surface",
             py::arg("name") = "", py::arg("progress") = py::none(),
             "Every wedge of a mesh, measured. exit: where an inner edge ends, 'surface' or 'extent'.");
  module.def(
      "read_wedges",
      [](const fs::path& path) {
        auto out = std::make_shared<Wedges>();
        out->file = value_of(read_wedges(path));
        warn_of_doubts(doubts_of(out->file, path.string()));
        return out;
      },
      py::arg("path"), "A wedges.json.");
}

}  // namespace dubsar::python
