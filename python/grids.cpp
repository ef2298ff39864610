// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar.Grid: a range grid whose samples numpy sees in place.

#include <algorithm>
#include <array>
#include <variant>

#include "acquisition/resample.h"
#include "core/units.h"
#include "core/utf8.h"
#include "formats/grid_file.h"
#include "formats/grid_ply.h"
#include "formats/grid_reader.h"
#include "formats/place_precision.h"
#include "formats/scan_folder.h"
#include "python/file_text.h"
#include "python/jobs.h"
#include "python/masked_input.h"

namespace dubsar::python {

namespace fs = std::filesystem;

namespace {

using Floats = MaskedInput<float>;
using MaybeFloats = std::optional<Floats>;

void check_shape(const py::array& array, int rows, int cols, const char* name) {
  if (array.ndim() != 2 || array.shape(0) != rows || array.shape(1) != cols) {
    raise(
        {ErrorKind::kUsage, std::string(name) + " has another shape than x", {}, "give rows x cols samples"});
  }
}

std::vector<float> floats_of(const Floats& array, const RangeGrid& grid, const char* name) {
  check_shape(array.values, grid.rows, grid.cols, name);
  return {array.values.data(), array.values.data() + array.values.size()};
}

/// What lies behind a mask is no sample.
template <class T>
void take_out_masked(const MaskedInput<T>& array, const char* name, RangeGrid& grid) {
  if (const std::optional<Input<bool>> mask = array.mask(name)) {
    for (std::size_t i = 0; i < grid.valid.size(); ++i) {
      grid.valid[i] = mask->data()[i] ? 0 : grid.valid[i];
    }
  }
}

/// What the samples have beside their places, a share of one each: a sample that stands cannot be without it.
std::vector<float> shares_of(const Floats& array, const RangeGrid& grid, const char* name) {
  std::vector<float> values = floats_of(array, grid, name);
  if (const std::optional<Input<bool>> mask = array.mask(name)) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (mask->data()[i] && grid.valid[i] != 0) {
        raise({ErrorKind::kUsage,
               std::string(name) + " is masked where the grid has a sample",
               {},
               "fill it, or give valid= without these samples"});
      }
      values[i] = mask->data()[i] ? 0 : values[i];
    }
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (grid.valid[i] != 0 && !(values[i] >= 0 && values[i] <= 1)) {
      raise({ErrorKind::kUsage,
             std::string(name) + " is not between 0 and 1",
             {},
             "give shares: of bytes, divided by 255; 0 for what is not known"});
    }
  }
  return values;
}

void check_spacing(double spacing_mm) {
  if (!(spacing_mm >= 0) || !std::isfinite(spacing_mm)) {
    raise({ErrorKind::kUsage, "spacing_mm is no length", {}, "give millimetres, or 0: not known"});
  }
}

GridPointer make_grid(const Floats& x, const Floats& y, const Floats& z,
                      const std::optional<MaskedInput<bool>>& valid, const MaybeFloats& intensity,
                      const MaybeFloats& confidence, double spacing_mm, const py::str& source) {
  constexpr py::ssize_t kMostSamples = 1 << 30;
  if (x.values.ndim() != 2 || x.values.size() == 0 || x.values.size() > kMostSamples) {
    raise({ErrorKind::kUsage, "x is no grid of rows x cols samples", {}, "give a two-dimensional array"});
  }
  check_spacing(spacing_mm);
  auto grid = std::make_shared<RangeGrid>();
  grid->rows = static_cast<int>(x.values.shape(0));
  grid->cols = static_cast<int>(x.values.shape(1));
  grid->x = floats_of(x, *grid, "x");
  grid->y = floats_of(y, *grid, "y");
  grid->z = floats_of(z, *grid, "z");
  grid->valid.assign(grid->x.size(), 1);
  if (valid) {
    check_shape(valid->values, grid->rows, grid->cols, "valid");
    std::copy_n(valid->values.data(), grid->valid.size(), grid->valid.begin());
    take_out_masked(*valid, "valid", *grid);
  }
  take_out_masked(x, "x", *grid);
  take_out_masked(y, "y", *grid);
  take_out_masked(z, "z", *grid);
  for (std::size_t i = 0; i < grid->valid.size(); ++i) {
    if (!std::isfinite(grid->x[i]) || !std::isfinite(grid->y[i]) || !std::isfinite(grid->z[i])) {
      grid->valid[i] = 0;
    }
    if (grid->valid[i] == 0) {
      grid->x[i] = grid->y[i] = grid->z[i] = 0;
    }
  }
  if (intensity) {
    grid->intensity = shares_of(*intensity, *grid, "intensity");
  }
  if (confidence) {
    grid->confidence = shares_of(*confidence, *grid, "confidence");
  }
  grid->spacing_mm = spacing_mm > 0 ? spacing_mm : estimate_spacing_mm(*grid);
  grid->source = bytes_of(source);
  value_of(check_precision(*grid, grid->source.empty() ? "the grid" : grid->source));
  return grid;
}

Result<std::vector<fs::path>> scan_files(const fs::path& path, std::vector<std::string>& remarks) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) {
    return std::vector{path};
  }
  Result<ScanFolder> folder = look_into_folder(path);
  if (!folder) {
    return std::unexpected(folder.error());
  }
  if (const std::string passed_over = folder->passed_over(); !passed_over.empty()) {
    remarks.push_back(one_line(path.string() + ": " + passed_over));
  }
  return std::move(folder->scans);
}

/// `remarks` takes what the readers remark on the scans, one line each.
Result<std::vector<GridPointer>> read_grids(const fs::path& path, std::optional<double> mm_per_unit,
                                            std::vector<std::string>& remarks, JobContext& job) {
  GridReadOptions options{.mm_per_unit = mm_per_unit};
  options.remark = [&remarks](const std::string& scan, const std::string& remark) {
    remarks.push_back(one_line(scan + ": " + remark));
  };
  std::vector<GridPointer> out;
  const Result<std::vector<fs::path>> files = scan_files(path, remarks);
  if (!files) {
    return std::unexpected(files.error());
  }
  for (std::size_t k = 0; k < files->size(); ++k) {
    job.progress("reading", static_cast<double>(k) / static_cast<double>(files->size()));
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "stopped");
    }
    Result<std::vector<ScanData>> scans = read_scan_file((*files)[k], options);
    if (!scans) {
      return std::unexpected(scans.error());
    }
    for (ScanData& scan : *scans) {
      if (auto* grid = std::get_if<RangeGrid>(&scan)) {
        out.push_back(std::make_shared<RangeGrid>(std::move(*grid)));
        continue;
      }
      Result<RangeGrid> grid = resample(std::get<PointCloud>(scan), {}, job);
      if (!grid) {
        return std::unexpected(grid.error());
      }
      out.push_back(std::make_shared<RangeGrid>(std::move(*grid)));
    }
  }
  if (out.empty()) {
    return bad_input(path.string(), "no scan in it", "give a folder or a file of range grids");
  }
  for (const GridPointer& grid : out) {
    if (grid->spacing_mm <= 0) {
      grid->spacing_mm = estimate_spacing_mm(*grid);
    }
  }
  return out;
}

Status write_grid(const fs::path& path, const RangeGrid& grid) {
  if (path.extension() == ".grid") {
    return write_grid_file(path, grid);
  }
  if (path.extension() == ".ply") {
    return write_grid_ply(path, grid);
  }
  return fail(ErrorKind::kUsage, "no format of range grids has this ending", path.string(),
              "use .grid or .ply");
}

/// One array of the grid as [rows, cols], without a copy; None when the grid has none.
template <class T>
auto plane(std::vector<T> RangeGrid::*member) {
  return [member](const GridPointer& grid) -> py::object {
    const std::vector<T>& values = (*grid).*member;
    if (values.empty()) {
      return py::none();
    }
    return view_of(values.data(), {grid->rows, grid->cols}, py::cast(grid));
  };
}

py::object colour_plane(const GridPointer& grid) {
  if (grid->rgb.empty()) {
    return py::none();
  }
  return view_of(grid->rgb.data(), {grid->rows, grid->cols, 3}, py::cast(grid));
}

/// A byte of 0 or 1 a cell is numpy's bool.
py::object valid_plane(const GridPointer& grid) {
  static_assert(sizeof(bool) == 1);
  return py::array(py::dtype::of<bool>(), {grid->rows, grid->cols}, grid->valid.data(), py::cast(grid));
}

py::array_t<float> valid_points(const RangeGrid& grid) {
  py::array_t<float> out({static_cast<py::ssize_t>(grid.valid_count()), py::ssize_t{3}});
  float* to = out.mutable_data();
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0) {
      *to++ = grid.x[i];
      *to++ = grid.y[i];
      *to++ = grid.z[i];
    }
  }
  return out;
}

}  // namespace

void bind_grids(py::module_& module) {
  py::class_<RangeGrid, GridPointer>(
      module, "Grid",
      "One range image: rows x cols samples in the scanner frame, millimetres. "
      "The arrays are views: what is written into them is in the grid.")
      .def(py::init(&make_grid), py::arg("x"), py::arg("y"), py::arg("z"), py::arg("valid") = py::none(),
           py::arg("intensity") = py::none(), py::arg("confidence") = py::none(), py::arg("spacing_mm") = 0.0,
           py::arg("source") = "",
           "Copies [rows, cols] arrays. Samples that are not finite are not valid. spacing_mm 0: estimated.")
      .def_readonly("rows", &RangeGrid::rows)
      .def_readonly("cols", &RangeGrid::cols)
      .def_property_readonly("shape", [](const RangeGrid& g) { return py::make_tuple(g.rows, g.cols); })
      .def_property_readonly("x", plane(&RangeGrid::x), "[rows, cols] float32, mm")
      .def_property_readonly("y", plane(&RangeGrid::y), "[rows, cols] float32, mm")
      .def_property_readonly("z", plane(&RangeGrid::z), "[rows, cols] float32, mm")
      .def_property_readonly("valid", &valid_plane, "[rows, cols] bool, True where there was a return")
      .def_property_readonly("intensity", plane(&RangeGrid::intensity), "[rows, cols] in [0, 1], or None")
      .def_property_readonly("confidence", plane(&RangeGrid::confidence), "[rows, cols] in [0, 1], or None")
      .def_property_readonly("rgb", &colour_plane, "[rows, cols, 3] uint8, or None")
      .def_property(
          "spacing_mm", [](const RangeGrid& g) { return g.spacing_mm; },
          [](RangeGrid& g, double spacing_mm) {
            check_spacing(spacing_mm);
            g.spacing_mm = spacing_mm;
          },
          "nominal lateral spacing, mm; 0: not known")
      .def_property(
          "source", [](const RangeGrid& g) { return text_of(g.source); },
          [](RangeGrid& g, const py::str& source) { g.source = bytes_of(source); },
          "the scan's original file name")
      .def_property_readonly("device", [](const RangeGrid& g) { return text_of(g.device); })
      .def("points", &valid_points, "[n, 3] float32, the valid samples in row order; a copy")
      .def("__len__", &RangeGrid::valid_count)
      .def("__repr__", [](const RangeGrid& g) {
        return text_of("<dubsar.Grid " + std::to_string(g.rows) + " x " + std::to_string(g.cols) + ", " +
                       std::to_string(g.valid_count()) + " samples" +
                       (g.source.empty() ? "" : ", " + g.source) + ">");
      });
  module.def(
      "read_grids",
      [](const fs::path& path, const std::optional<std::string>& unit, const py::object& progress) {
        const std::optional<double> scale = mm_per_unit_named(unit);
        std::vector<std::string> remarks;
        auto grids =
            run_for_result(progress, [&](JobContext& job) { return read_grids(path, scale, remarks, job); });
        for (const std::string& remark : remarks) {
          warn_of_scan(remark);
        }
        return grids;
      },
      py::arg("path"), py::arg("unit") = py::none(), py::arg("progress") = py::none(),
      "The range grids of a file, or of a folder in name order. Points without an order are resampled. A "
      "scan "
      "that is read otherwise than its file says, or that is doubtful, is warned of (ScanWarning).");
  module.def(
      "write_grid",
      [](const fs::path& path, const GridPointer& grid) {
        check_may_write(path);
        run_for_result(py::none(), [&](JobContext&) { return write_grid(path, *grid); });
      },
      py::arg("path"), py::arg("grid").none(false),
      "As .grid (every field) or range-grid .ply; whole or not at all.");
}

}  // namespace dubsar::python
