// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// From range grids to poses, and from grids in their places to a mesh.

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "core/scan_copies.h"
#include "core/utf8.h"
#include "formats/pins_json.h"
#include "formats/poses_json.h"
#include "planning/sparse_flags.h"
#include "python/file_text.h"
#include "python/jobs.h"
#include "python/masked_input.h"
#include "python/paired_poses.h"
#include "registration/registrar.h"
#include "station/outward_faces.h"
#include "station/poses_scale.h"
#include "station/station_scan.h"
#include "station/stitch_scans.h"
#include "station/stitch_warnings.h"
#include "station/tablet_flags.h"
#include "triangulation/placed_precision.h"
#include "triangulation/stitcher.h"

namespace dubsar::python {

namespace fs = std::filesystem;

namespace {

using Grids = std::vector<GridPointer>;

/// Whoever writes NaN into the view of a grid means no sample; its mask does not say so.
void check_samples(const Grids& grids, std::size_t place) {
  const RangeGrid& grid = *grids[place];
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0 && !grid.point(i).allFinite()) {
      const auto cols = static_cast<std::size_t>(grid.cols);
      raise({ErrorKind::kUsage,
             grid_name(grids, static_cast<int>(place)) + " has a sample that is not finite, in row " +
                 std::to_string(i / cols) + ", column " + std::to_string(i % cols),
             {},
             "set valid to False there"});
    }
  }
}

void check_grids(const Grids& grids) {
  for (std::size_t k = 0; k < grids.size(); ++k) {
    if (!grids[k] || grids[k]->size() == 0) {
      raise({ErrorKind::kUsage, "grid " + std::to_string(k) + " is empty", {}, "give range grids"});
    }
    check_samples(grids, k);
  }
}

struct Registered {
  std::vector<ScanPose> poses;
  std::vector<ScanCopy> copies;  ///< grids that count as another
};

Result<Registered> register_grids(const Grids& grids, const PinSet* pins,
                                  const std::vector<std::optional<RigidTransform>>& starts, JobContext& job) {
  Registrar registrar;
  for (std::size_t k = 0; k < grids.size(); ++k) {
    job.progress("registering", static_cast<double>(k) / static_cast<double>(grids.size() + 1));
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "stopped");
    }
    const int id = static_cast<int>(k);
    // As long as the caller waits here, nobody takes the grid away.
    if (k < starts.size() && starts[k]) {
      registrar.add_at(id, grids[k], pins, *starts[k], false, job);
    } else {
      registrar.add(id, grids[k], pins, job);
    }
  }
  if (const Status done = registrar.finalize(job); !done) {
    return std::unexpected(done.error());
  }
  job.progress("registering", 1.0);
  Registered out{registrar.poses(), {}};
  KnownPrints prints;
  for (ScanPose& pose : out.poses) {
    const RangeGrid& grid = *grids[static_cast<std::size_t>(pose.id)];
    pose.file = grid.source;
    pose = PlacedPrecision(grid).judged(std::move(pose));
    if (pose.status == PoseStatus::kRegistered) {
      prints.add(pose.id, scan_print(grid));
    }
  }
  out.copies = prints.copies();
  return out;
}

struct Stitched {
  Mesh mesh;
  std::vector<std::string> of_scans;  ///< what there is to say of them, as the command says it
  std::string of_mesh;                ///< the same; empty where there is nothing
};

StationScan scan_of(const Grids& grids, int place, const std::optional<PinSet>& pins) {
  const GridPointer& grid = grids[static_cast<std::size_t>(place)];
  StationScan scan;
  // As long as the caller waits here, nobody takes the grid away: it is copied where it must be changed.
  if (pins || grid->pin_tip_diameter_mm > 0 || grid->spacing_mm <= 0) {
    scan = prepare_scan(place, *grid, pins);
  } else {
    scan.id = place;
    scan.grid = scan.measured = grid;
    scan.flags = std::make_shared<const SampleFlags>(flag_sparse(*grid));
  }
  scan.file = grid_name(grids, place);
  return scan;
}

/// Those of the poses that are registered, made ready; what the others are is said.
Result<std::vector<StationScan>> registered_scans(const Grids& grids, const std::vector<ScanPose>& poses,
                                                  const std::optional<PinSet>& pins, const JobContext& job,
                                                  std::vector<std::string>& said) {
  std::vector<StationScan> scans;
  PosesScale scale;
  for (int place = 0; std::cmp_less(place, grids.size()); ++place) {
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "stopped");
    }
    const std::string name = grid_name(grids, place);
    const auto pose = std::ranges::find(poses, place, &ScanPose::id);
    if (pose == poses.end()) {
      said.push_back(left_out_sentence(name, "", "there is no pose of it"));
      continue;
    }
    if (pose->status != PoseStatus::kRegistered) {
      said.push_back(left_out_sentence(name, to_string(pose->status), pose->reason));
      continue;
    }
    scans.push_back(scan_of(grids, place, pins));
    if (const std::string impossible = size_fault(*scans.back().grid); !impossible.empty()) {
      return bad_input(name, impossible);
    }
    scale.add(*scans.back().grid, pose->model_from_scanner);
  }
  if (const std::string fault = scale.fault(); !fault.empty()) {
    said.push_back("the list of poses: " + fault);
  }
  return scans;
}

/// `poses` by the places of their grids.
Result<Stitched> stitch_grids(const Grids& grids, const std::vector<ScanPose>& poses,
                              const std::optional<PinSet>& pins, JobContext& job) {
  Stitched out;
  const Result<std::vector<StationScan>> scans = registered_scans(grids, poses, pins, job, out.of_scans);
  if (!scans) {
    return std::unexpected(scans.error());
  }
  if (scans->empty()) {
    return fail(ErrorKind::kUsage, "no scan is registered", {}, "see the poses' reasons");
  }
  std::map<int, std::string> names;
  for (const StationScan& scan : *scans) {
    names[scan.id] = scan.file;
  }
  Stitcher stitcher;
  job.progress("triangulate grids", 0.0);
  const Result<std::vector<ForeignFound>> foreign = add_without_foreign(stitcher, *scans, poses, job);
  if (!foreign) {
    return std::unexpected(foreign.error());
  }
  if (const Status ready = stitcher.update(job); !ready) {
    return std::unexpected(ready.error());
  }
  const auto leave_out_copies = [&](const std::vector<ScanCopy>& copies) {
    for (const ScanCopy& copy : copies) {
      out.of_scans.push_back(left_out_sentence(names.at(copy.id), "", copy_reason(copy, names)));
    }
    for (const ScanCopy& copy : copies) {
      names.erase(copy.id);
    }
  };
  for (const ForeignFound& found : *foreign) {
    if (!found.is_all()) {
      out.of_scans.push_back(sentence_of(found));
      continue;
    }
    out.of_scans.push_back(left_out_sentence(names.at(found.id), "", reason_of_all(found)));
    leave_out_copies(take_out_with_copies(stitcher, found));
    names.erase(found.id);
  }
  leave_out_copies(stitcher.copies());
  for (const int id : stitcher.without_surface()) {
    out.of_scans.push_back(left_out_sentence(names.at(id), "", no_surface_reason()));
    names.erase(id);
  }
  std::ranges::move(warnings_of_places(stitcher, names), std::back_inserter(out.of_scans));
  Result<Mesh> mesh = stitcher.take_mesh(job);
  if (!mesh) {
    return std::unexpected(mesh.error());
  }
  if (const Status has = check_has_surface(*mesh, "the list of grids"); !has) {
    return std::unexpected(has.error());
  }
  if (const std::optional<Error> wrong_way = inside_out(*mesh, "the mesh")) {
    out.of_mesh = wrong_way->line();
  }
  out.mesh = std::move(*mesh);
  return out;
}

void warn_of_copies(const std::vector<ScanCopy>& copies) {
  for (const ScanCopy& copy : copies) {
    warn_of_scan("grid " + std::to_string(copy.id) + " has the very samples of grid " +
                 std::to_string(copy.of_id) + ", and counts as the same scan");
  }
}

std::optional<PinSet> pins_of(const std::optional<fs::path>& file) {
  return file ? std::optional(value_of(read_pins(*file))) : std::nullopt;
}

ScanPose make_pose(int id, const MaskedInput<double>& model_from_scanner, const py::str& file,
                   double sigma_mm) {
  ScanPose pose;
  pose.id = id;
  pose.file = bytes_of(file);
  pose.model_from_scanner = transform_of(model_from_scanner, "model_from_scanner");
  pose.status = PoseStatus::kRegistered;
  if (!(sigma_mm >= 0) || !std::isfinite(sigma_mm)) {
    raise({ErrorKind::kUsage, "sigma_mm is no standard deviation", {}, "give 0 or more"});
  }
  pose.sigma_mm = sigma_mm;
  return pose;
}

py::object covariance_of(const ScanPose& pose) {
  if (!pose.covariance) {
    return py::none();
  }
  py::array_t<double> out({6, 6});
  for (int row = 0; row < 6; ++row) {
    for (int col = 0; col < 6; ++col) {
      out.mutable_at(row, col) = (*pose.covariance)(row, col);
    }
  }
  return out;
}

void bind_pose(py::module_& module) {
  py::class_<ScanPose>(module, "Pose", "Where a scan lies, and how sure that is.")
      .def(py::init(&make_pose), py::arg("id"), py::arg("model_from_scanner"), py::arg("file") = "",
           py::arg("sigma_mm") = 0.0, "A pose that is known from elsewhere: it counts as registered.")
      .def_readonly("id", &ScanPose::id, "the scan's place in the list of grids; stitch() goes by file first")
      .def_property_readonly("file", [](const ScanPose& pose) { return text_of(pose.file); })
      .def_property_readonly(
          "status", [](const ScanPose& pose) { return to_string(pose.status); },
          "'registered', 'unsure' or 'failed'")
      .def_property_readonly("registered",
                             [](const ScanPose& pose) { return pose.status == PoseStatus::kRegistered; })
      .def_property_readonly(
          "model_from_scanner", [](const ScanPose& pose) { return matrix_of(pose.model_from_scanner); },
          "[4, 4], mm; means nothing when failed")
      .def_readonly("rms_mm", &ScanPose::rms_mm)
      .def_readonly("sigma_mm", &ScanPose::sigma_mm)
      .def_readonly("overlap", &ScanPose::overlap)
      .def_property_readonly("reason", [](const ScanPose& pose) { return text_of(pose.reason); })
      .def_property_readonly("warning", [](const ScanPose& pose) { return text_of(pose.warning); })
      .def_property_readonly("covariance", &covariance_of,
                             "[6, 6] of (omega rad, v mm) about the scan's centroid, or None")
      .def("__repr__", [](const ScanPose& pose) {
        return text_of("<dubsar.Pose " + std::to_string(pose.id) + " " + to_string(pose.status) +
                       (pose.reason.empty() ? "" : ": " + pose.reason) + ">");
      });
}

}  // namespace

void bind_scans(py::module_& module) {
  bind_pose(module);
  module.def(
      "register",
      [](const Grids& grids, const std::optional<std::vector<std::optional<MaskedInput<double>>>>& starts,
         const std::optional<fs::path>& pins_file, const py::object& progress) {
        check_grids(grids);
        const std::optional<PinSet> pins = pins_of(pins_file);
        std::vector<std::optional<RigidTransform>> from;
        if (starts) {
          if (starts->size() != grids.size()) {
            raise(
                {ErrorKind::kUsage, "starts has another length than grids", {}, "give one, or None, a grid"});
          }
          for (const auto& start : *starts) {
            from.push_back(start ? std::optional(transform_of(*start, "a start")) : std::nullopt);
          }
        }
        Registered registered = run_for_result(progress, [&](JobContext& job) {
          return register_grids(grids, pins ? &*pins : nullptr, from, job);
        });
        warn_of_copies(registered.copies);
        return std::move(registered.poses);
      },
      py::arg("grids"), py::arg("starts") = py::none(), py::arg("pins") = py::none(),
      py::arg("progress") = py::none(),
      "The poses of grids, in their order. A pose that is not certain is 'unsure' or 'failed' and says why. "
      "starts: for each grid a [4, 4] model_from_scanner to begin with, or None. pins: a pins.json. A grid "
      "with the very samples of another counts once, and is warned of (ScanWarning).");
  module.def(
      "stitch",
      [](const Grids& grids, const std::vector<ScanPose>& poses, const std::optional<fs::path>& pins_file,
         const py::object& progress) {
        check_grids(grids);
        const std::vector<ScanPose> paired = paired_poses(poses, grids);
        const std::optional<PinSet> pins = pins_of(pins_file);
        Stitched stitched =
            run_for_result(progress, [&](JobContext& job) { return stitch_grids(grids, paired, pins, job); });
        for (const std::string& line : stitched.of_scans) {
          warn_of_scan(one_line(line));
        }
        if (!stitched.of_mesh.empty()) {
          warn_of_mesh(stitched.of_mesh);
        }
        return std::make_shared<Mesh>(std::move(stitched.mesh));
      },
      py::arg("grids"), py::arg("poses"), py::arg("pins") = py::none(), py::arg("progress") = py::none(),
      "One oriented 2-manifold of the registered scans. A pose is of the grid whose source its file names, "
      "where each pose has a file that is the source of just one grid, whatever the order of either list; "
      "else of the grid whose place in the list is its id, and a file that names another grid is refused. "
      "What is no part of the mesh, what was in the way of a scan and which poses look wrong is warned of "
      "(ScanWarning), as the command does, by the grids' places.");
  module.def(
      "read_poses", [](const fs::path& path) { return value_of(read_poses(path)); }, py::arg("path"));
  module.def(
      "write_poses",
      [](const fs::path& path, const std::vector<ScanPose>& poses) {
        check_may_write(path);
        value_of(write_poses(path, poses));
      },
      py::arg("path"), py::arg("poses"));
}

}  // namespace dubsar::python
