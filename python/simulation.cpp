// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Simulated tablets and scans of them, whose truth is known.

#include "core/mesh_query.h"
#include "core/scan_pose.h"
#include "python/jobs.h"
#include "sim/scan_plan.h"
#include "sim/scanner.h"
#include "sim/tablet.h"
#include "station/tablet_file.h"

namespace dubsar::python {

namespace {

using TabletPointer = std::shared_ptr<sim::SimTablet>;

struct SimulatedScans {
  std::vector<GridPointer> grids;
  std::vector<ScanPose> poses;
};

Result<SimulatedScans> scan_tablet(const sim::SimTablet& tablet, int views, double spacing_mm,
                                   double noise_mm, std::uint64_t seed, JobContext& job) {
  const MeshQuery query(tablet.mesh);
  sim::ScannerOptions options;
  options.spacing_mm = spacing_mm;
  options.noise_mm = noise_mm;
  options.seed = seed;
  const sim::TriangulationScanner scanner{fitted_to(options, tablet)};
  const std::vector<sim::PlannedView> plan = sim::plan_views(views, seed);
  SimulatedScans out;
  for (std::size_t k = 0; k < plan.size(); ++k) {
    job.progress("scanning", static_cast<double>(k) / static_cast<double>(plan.size()));
    const sim::Scene scene{&tablet, &query, {}, std::nullopt};
    Result<RangeGrid> grid = scanner.scan_grid(scene, plan[k].tablet_from_scanner, k, job);
    if (!grid) {
      return std::unexpected(grid.error());
    }
    out.grids.push_back(std::make_shared<RangeGrid>(std::move(*grid)));
    ScanPose pose;
    pose.id = static_cast<int>(k);
    pose.model_from_scanner = plan[k].tablet_from_scanner;
    pose.status = PoseStatus::kRegistered;
    pose.overlap = 1;
    out.poses.push_back(pose);
  }
  job.progress("scanning", 1.0);
  return out;
}

void need(bool good, const char* what, const char* mend) {
  if (!good) {
    raise({ErrorKind::kUsage, what, {}, mend});
  }
}

}  // namespace

void bind_simulation(py::module_& module) {
  py::class_<sim::SimTablet, TabletPointer>(module, "SimulatedTablet",
                                            "A made-up tablet whose truth is known.")
      .def_property_readonly(
          "mesh", [](const TabletPointer& t) { return std::shared_ptr<Mesh>(t, &t->mesh); },
          "the true surface")
      .def_property_readonly(
          "wedges", [](const sim::SimTablet& t) { return wedge_rows(t.wedges); },
          "the true wedges, as Wedges.table has them");
  module.def(
      "simulate_tablet",
      [](std::uint64_t seed, const std::array<double, 3>& size_mm, double spacing_mm, double damage,
         const py::object& progress) {
        need(spacing_mm >= 0.005 && spacing_mm <= 5, "spacing_mm is out of bounds", "give 0.005 to 5");
        need(damage >= 0 && damage <= 1, "damage is out of bounds", "give 0 to 1");
        sim::TabletOptions options;
        options.seed = seed;
        options.size_mm = {size_mm[0], size_mm[1], size_mm[2]};
        options.spacing_mm = spacing_mm;
        options.damage = {damage, damage, damage, damage, 0};
        return std::make_shared<sim::SimTablet>(
            run_for_result(progress, [&](JobContext& job) { return sim::make_tablet(options, job); }));
      },
      py::arg("seed") = 1, py::arg("size_mm") = std::array{50.0, 40.0, 20.0}, py::arg("spacing_mm") = 0.1,
      py::arg("damage") = 0.3, py::arg("progress") = py::none(), "The same seed gives the same bytes.");
  module.def(
      "simulate_scans",
      [](const TabletPointer& tablet, int views, double spacing_mm, double noise_mm, std::uint64_t seed,
         const py::object& progress) {
        check_sound(tablet->mesh);
        need(views >= 1 && views <= 10000, "views is out of bounds", "give 1 to 10000");
        need(spacing_mm >= 0.005 && spacing_mm <= 5, "spacing_mm is out of bounds", "give 0.005 to 5");
        need(noise_mm >= 0 && noise_mm <= 5, "noise_mm is out of bounds", "give 0 to 5");
        SimulatedScans scans = run_for_result(progress, [&](JobContext& job) {
          return scan_tablet(*tablet, views, spacing_mm, noise_mm, seed, job);
        });
        return std::pair(std::move(scans.grids), std::move(scans.poses));
      },
      py::arg("tablet").none(false), py::arg("views") = 12, py::arg("spacing_mm") = 0.1,
      py::arg("noise_mm") = 0.02, py::arg("seed") = 1, py::arg("progress") = py::none(),
      "Grids, and their true poses: a tablet turned by hand before a triangulation scanner.");
}

}  // namespace dubsar::python
