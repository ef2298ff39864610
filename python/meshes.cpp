// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar.Mesh: a triangle mesh whose arrays numpy sees in place, and the mesh check.

#include <algorithm>
#include <limits>
#include <span>

#include "core/inside_out.h"
#include "core/rigid_matrix.h"
#include "core/units.h"
#include "formats/mesh_io.h"
#include "formats/place_precision.h"
#include "python/jobs.h"
#include "python/masked_input.h"
#include "station/mesh_json.h"
#include "triangulation/mesh_check.h"

namespace dubsar::python {

namespace fs = std::filesystem;

namespace {

using MeshPointer = std::shared_ptr<Mesh>;
static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));

void check_rows(const py::array& array, py::ssize_t rows, const char* name) {
  if (array.ndim() != 2 || array.shape(1) != 3 || (rows >= 0 && array.shape(0) != rows)) {
    raise({ErrorKind::kUsage, std::string(name) + " has the wrong shape", {}, "give three numbers a row"});
  }
}

std::vector<Eigen::Vector3f> vectors_of(const Input<float>& array) {
  std::vector<Eigen::Vector3f> out(static_cast<std::size_t>(array.shape(0)));
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = Eigen::Map<const Eigen::Vector3f>(array.data() + 3 * i);
  }
  return out;
}

[[noreturn]] void raise_no_vertex(std::size_t face, std::int64_t vertex, std::int64_t count) {
  raise({ErrorKind::kUsage,
         "face " + std::to_string(face) + " names vertex " + std::to_string(vertex) + " of " +
             std::to_string(count),
         {},
         "give indices from 0"});
}

/// numpy would cut 0.7 to 0, and take True for 1.
Input<std::int64_t> whole_numbers(const py::object& given) {
  check_unmasked(given, "faces");
  const auto faces = py::array::ensure(given);
  const char kind = faces ? faces.dtype().kind() : '?';
  if (!faces || (kind != 'i' && kind != 'u' && faces.size() > 0)) {
    raise({ErrorKind::kUsage, "faces are no whole numbers", {}, "give indices from 0, of an integer type"});
  }
  check_rows(faces, -1, "faces");
  return Input<std::int64_t>(faces);
}

/// A mesh has no vertex without a place.
Input<float> whole(const MaskedInput<float>& array, const char* name) {
  check_unmasked(array.given, name);
  return array.values;
}

MeshPointer make_mesh(const MaskedInput<float>& given_vertices, const py::object& given_faces,
                      const std::optional<MaskedInput<float>>& given_normals,
                      const std::optional<MaskedInput<float>>& given_reliability) {
  const Input<float> vertices = whole(given_vertices, "vertices");
  check_rows(vertices, -1, "vertices");
  const Input<std::int64_t> faces = whole_numbers(given_faces);
  auto mesh = std::make_shared<Mesh>();
  mesh->positions = vectors_of(vertices);
  const auto count = static_cast<std::int64_t>(mesh->positions.size());
  mesh->faces.resize(static_cast<std::size_t>(faces.shape(0)));
  for (std::size_t f = 0; f < mesh->faces.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t vertex = faces.data()[3 * f + k];
      if (vertex < 0 || vertex >= count) {
        raise_no_vertex(f, vertex, count);
      }
      mesh->faces[f][k] = static_cast<std::uint32_t>(vertex);
    }
  }
  if (given_normals) {
    const Input<float> normals = whole(*given_normals, "normals");
    check_rows(normals, count, "normals");
    mesh->normals = vectors_of(normals);
  }
  if (given_reliability) {
    const Input<float> reliability = whole(*given_reliability, "reliability");
    if (reliability.size() != count) {
      raise({ErrorKind::kUsage, "reliability has the wrong length", {}, "give one number a vertex"});
    }
    mesh->reliability.assign(reliability.data(), reliability.data() + count);
    if (!std::ranges::all_of(mesh->reliability, [](float r) { return r >= 0 && r <= 1; })) {
      raise({ErrorKind::kUsage,
             "reliability is not between 0 and 1",
             {},
             "give shares: 0 for what is not known"});
    }
  }
  check_sound(*mesh);
  value_of(check_precision(*mesh, "the mesh"));
  return mesh;
}

template <class T>
auto column(std::vector<T> Mesh::*member) {
  return [member](const MeshPointer& mesh) -> py::object {
    const std::vector<T>& values = (*mesh).*member;
    if (values.empty()) {
      return py::none();
    }
    return view_of(values.data(), {static_cast<py::ssize_t>(values.size())}, py::cast(mesh));
  };
}

/// Rows of three; an empty array where `always`, otherwise None.
template <class Number, class Row>
auto rows(std::vector<Row> Mesh::*member, bool always) {
  static_assert(sizeof(Row) == 3 * sizeof(Number));
  return [member, always](const MeshPointer& mesh) -> py::object {
    const std::vector<Row>& values = (*mesh).*member;
    if (values.empty()) {
      return always ? py::object(py::array_t<Number>(std::vector<py::ssize_t>{0, 3}))
                    : py::object(py::none());
    }
    return view_of(reinterpret_cast<const Number*>(values.data()),
                   {static_cast<py::ssize_t>(values.size()), 3}, py::cast(mesh));
  };
}

/// What `dubsar mesh check --json` says, key by key.
py::dict report_of(const MeshReport& report, bool inside_out) {
  py::dict out;
  const nlohmann::ordered_json said = mesh_report_json(report);
  for (const auto& [key, value] : said.items()) {
    if (value.is_boolean()) {
      out[key.c_str()] = value.get<bool>();
    } else if (value.is_array()) {
      out[key.c_str()] = py::tuple(py::cast(value.get<std::vector<double>>()));
    } else if (value.is_number_float()) {
      out[key.c_str()] = value.get<double>();
    } else {
      out[key.c_str()] = value.get<std::size_t>();
    }
  }
  out["inside_out"] = inside_out;
  return out;
}

}  // namespace

void bind_meshes(py::module_& module) {
  py::class_<Mesh, MeshPointer>(
      module, "Mesh",
      "A triangle mesh, millimetres. The arrays are views: what is written into them "
      "is in the mesh.")
      .def(py::init(&make_mesh), py::arg("vertices"), py::arg("faces"), py::arg("normals") = py::none(),
           py::arg("reliability") = py::none(), "Copies [V, 3] vertices and [F, 3] indices of vertices.")
      .def_property_readonly("vertices", rows<float>(&Mesh::positions, true), "[V, 3] float32, mm")
      .def_property_readonly("faces", rows<std::uint32_t>(&Mesh::faces, true), "[F, 3] uint32")
      .def_property_readonly("normals", rows<float>(&Mesh::normals, false), "[V, 3] unit, or None")
      .def_property_readonly("reliability", column(&Mesh::reliability), "[V] in [0, 1], or None")
      .def_property_readonly("sigma_mm", column(&Mesh::sigma_mm), "[V] along the normal, or None")
      .def_property_readonly("scans", column(&Mesh::scans), "[V] how many scans support it, or None")
      .def_property_readonly("flags", column(&Mesh::flags),
                             "[V] 1 sparse, 2 interpolated, 4 boundary, or None")
      .def_property_readonly("colours", rows<std::uint8_t>(&Mesh::colours, false), "[V, 3] uint8, or None")
      .def("__repr__", [](const Mesh& mesh) {
        return "<dubsar.Mesh " + std::to_string(mesh.positions.size()) + " vertices, " +
               std::to_string(mesh.faces.size()) + " faces>";
      });
  module.def(
      "read_mesh",
      [](const fs::path& path, const std::optional<std::string>& unit) {
        MeshReadOptions options{.mm_per_unit = mm_per_unit_named(unit)};
        return std::make_shared<Mesh>(run_for_result(py::none(), [&](JobContext& job) {
          options.job = &job;
          return read_mesh(path, options);
        }));
      },
      py::arg("path"), py::arg("unit") = py::none(), "PLY, OBJ, STL or GLB, in millimetres.");
  module.def(
      "write_mesh",
      [](const fs::path& path, const MeshPointer& mesh) {
        check_sound(*mesh);
        check_may_write(path);
        run_for_result(py::none(), [&](JobContext& job) {
          return write_mesh(path, *mesh, {.origin = "Written by Dubsar"}, &job);
        });
      },
      py::arg("path"), py::arg("mesh").none(false),
      "PLY, OBJ, STL or GLB by the ending (.draco.glb compresses); whole or not at all. PLY alone holds "
      "reliability, sigma_mm, scans and flags, each where it is not None.");
  module.def(
      "check_mesh",
      [](const MeshPointer& mesh) {
        check_sound(*mesh);
        MeshReport report;
        bool inside_out = false;
        run_job(py::none(), [&](JobContext& job) {
          report = check_mesh(*mesh, job);
          inside_out = is_inside_out(*mesh);
        });
        return report_of(report, inside_out);
      },
      py::arg("mesh").none(false), "Topology and size, as `dubsar mesh check` tells them.");
}

void check_sound(const Mesh& mesh) {
  const std::size_t count = mesh.positions.size();
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (const std::uint32_t vertex : mesh.faces[f]) {
      if (vertex >= count) {
        raise_no_vertex(f, vertex, static_cast<std::int64_t>(count));
      }
    }
  }
  for (std::size_t v = 0; v < count; ++v) {
    if (!mesh.positions[v].allFinite()) {
      raise({ErrorKind::kUsage,
             "vertex " + std::to_string(v) + " is not finite",
             {},
             "leave it out, and the faces that use it"});
    }
  }
}

py::array_t<double> matrix_of(const RigidTransform& transform) {
  py::array_t<double> out(std::vector<py::ssize_t>{4, 4});
  std::ranges::copy(transform.row_major(), out.mutable_data());
  return out;
}

RigidTransform transform_of(const MaskedInput<double>& given, const std::string& what) {
  check_unmasked(given.given, what);
  const Input<double>& matrix = given.values;
  if (matrix.ndim() == 2 && matrix.shape(0) == 4 && matrix.shape(1) == 4) {
    const auto transform = rigid_from_row_major(std::span<const double, 16>(matrix.data(), 16));
    if (transform) {
      return transform->orthonormalised();
    }
  }
  raise({ErrorKind::kUsage,
         what + " is no rigid transform",
         {},
         std::string("give a matrix ") + kRigidMatrixLayout});
}

std::optional<double> mm_per_unit_named(const std::optional<std::string>& unit) {
  if (!unit) {
    return std::nullopt;
  }
  const std::optional<double> scale = mm_per_unit(*unit);
  if (!scale) {
    raise({ErrorKind::kUsage, "no unit " + *unit, {}, "there are " + std::string(kLengthUnitsText)});
  }
  return scale;
}

}  // namespace dubsar::python
