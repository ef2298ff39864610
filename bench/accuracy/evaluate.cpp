// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar-evaluate: how far a result is from the truth. The truth never goes into the program that is judged.
//
//   dubsar-evaluate poses POSES.json SCANS --truth truth_poses.json | --conf bun.conf [--unit m] [--gauge-out
//   G.json] dubsar-evaluate mesh MESH REFERENCE --within 0.4 [--reference-unit m] [--gauge G.json]
//     how much of the reference's surface lies within that distance of the mesh, and the other way round

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <variant>

#include "bench/accuracy/gauge.h"
#include "bench/support/options.h"
#include "bench/support/statistics.h"
#include "core/mesh_query.h"
#include "core/parallel.h"
#include "core/units.h"
#include "formats/grid_reader.h"
#include "formats/mesh_io.h"
#include "formats/poses_conf.h"

namespace dubsar::accuracy {
namespace {

namespace fs = std::filesystem;
using bench::quantile;
struct NamedPose {
  int id = -1;
  RigidTransform model_from_scanner;
};
using Poses = std::map<std::string, NamedPose>;  // by file name

[[noreturn]] void die(const std::string& text) {
  std::fprintf(stderr, "dubsar-evaluate: %s\n", text.c_str());
  std::exit(2);
}

Poses read_json_poses(const fs::path& path, bool registered_only) {
  std::ifstream in(path);
  const nlohmann::json json = nlohmann::json::parse(in, nullptr, false);
  if (!json.contains("scans")) {
    die(path.string() + ": no scans in it");
  }
  Poses poses;
  for (const auto& scan : json["scans"]) {
    if (registered_only && scan.value("status", "registered") != "registered") {
      continue;
    }
    poses[fs::path(scan.at("file").get<std::string>()).filename()] = {
        scan.value("id", -1),
        RigidTransform::from_row_major(scan.at("model_from_scanner").get<std::array<double, 16>>())};
  }
  return poses;
}

std::vector<Eigen::Vector3d> sample_points(const ScanData& data) {
  std::vector<Eigen::Vector3d> points;
  if (const auto* grid = std::get_if<RangeGrid>(&data)) {
    const std::size_t step = std::max<std::size_t>(1, grid->valid_count() / 4000);
    std::size_t seen = 0;
    for (std::size_t i = 0; i < grid->size(); ++i) {
      if (grid->valid[i] != 0 && seen++ % step == 0) {
        points.push_back(grid->point(i).cast<double>());
      }
    }
  }
  return points;
}

int evaluate_poses(const fs::path& poses_file, const fs::path& scans, const fs::path& truth_file,
                   const fs::path& conf, double mm_per_file_unit, const fs::path& gauge_out) {
  const Poses estimated = read_json_poses(poses_file, true);
  Poses truth;
  if (conf.empty()) {
    truth = read_json_poses(truth_file, false);
  } else {
    const Result<std::vector<ScanPose>> published = read_conf_poses(conf, mm_per_file_unit);
    if (!published) {
      die(published.error().line());
    }
    for (const ScanPose& pose : *published) {
      truth[pose.file] = {-1, pose.model_from_scanner};
    }
  }
  std::vector<PosePair> pairs;
  std::vector<std::string> names;
  for (const auto& [file, pose] : truth) {
    char number[32];
    std::snprintf(number, sizeof number, "grids/%03d.grid", pose.id);
    const fs::path path = fs::is_directory(scans / "grids") ? scans / number : scans / file;
    if (!fs::exists(path)) {
      continue;
    }
    const auto found = estimated.find(file);
    if (found == estimated.end()) {
      std::printf("%-28s not registered\n", file.c_str());
      continue;
    }
    const auto data = read_scan_file(path, {.mm_per_unit = mm_per_file_unit});
    if (!data) {
      die(data.error().line());
    }
    pairs.push_back(
        {sample_points(data->front()), pose.model_from_scanner, found->second.model_from_scanner});
    names.push_back(file);
  }
  if (pairs.empty()) {
    die(scans.string() + ": none of the scans that the truth names; give their folder, or the session");
  }
  const RigidTransform gauge = truth_from_model(pairs);
  std::vector<double> all;
  double worst_deg = 0;
  double worst_mm = 0;
  std::printf("%-28s %10s %12s %10s\n", "scan", "deg", "centroid mm", "rms mm");
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const PoseError error = pose_error(pairs[k], gauge);
    std::printf("%-28s %10.4f %12.4f %10.4f\n", names[k].c_str(), deg_from_rad(error.rotation_rad),
                error.centroid_mm, error.rms_mm);
    worst_deg = std::max(worst_deg, deg_from_rad(error.rotation_rad));
    worst_mm = std::max(worst_mm, error.centroid_mm);
    all.insert(all.end(), error.displacements_mm.begin(), error.displacements_mm.end());
  }
  std::printf(
      "scans %zu of %zu, worst %.4f deg %.4f mm, surface displacement median %.4f mm, 95 %% %.4f mm\n",
      pairs.size(), truth.size(), worst_deg, worst_mm, quantile(all, 0.5), quantile(all, 0.95));
  if (!gauge_out.empty()) {
    std::ofstream(gauge_out) << nlohmann::json{{"truth_from_model", gauge.row_major()}}.dump();
  }
  return 0;
}

void distances(const char* what, const Mesh& from, const Mesh& to, double within_mm) {
  const MeshQuery query(to);
  std::vector<double> d(from.positions.size());
  parallel_for_each_index(d.size(), [&](std::size_t i) {
    const auto hit = query.closest(from.positions[i], static_cast<float>(20 * within_mm));
    d[i] = hit ? hit->distance_mm : 20 * within_mm;
  });
  double sum = 0;
  double sum2 = 0;
  std::size_t inside = 0;
  for (const double v : d) {
    sum += v;
    sum2 += v * v;
    inside += v <= within_mm ? 1 : 0;
  }
  const auto n = static_cast<double>(std::max<std::size_t>(1, d.size()));
  std::printf("%s: %zu vertices, %.3f %% within %.3f mm, mean %.4f, RMS %.4f, 95 %% %.4f mm\n", what,
              d.size(), 100.0 * static_cast<double>(inside) / n, within_mm, sum / n, std::sqrt(sum2 / n),
              quantile(d, 0.95));
}

int evaluate_mesh(const fs::path& mesh_file, const fs::path& reference_file, double within_mm,
                  const std::string& reference_unit, const fs::path& gauge_file) {
  auto mesh = read_mesh(mesh_file, {});
  auto reference = read_mesh(reference_file, {.mm_per_unit = mm_per_unit(reference_unit).value_or(1.0)});
  if (!mesh || !reference) {
    die((mesh ? reference : mesh).error().line());
  }
  if (!gauge_file.empty()) {
    std::ifstream in(gauge_file);
    const auto json = nlohmann::json::parse(in);
    const RigidTransform gauge =
        RigidTransform::from_row_major(json.at("truth_from_model").get<std::array<double, 16>>());
    for (Eigen::Vector3f& p : mesh->positions) {
      p = (gauge * p.cast<double>()).cast<float>();
    }
  }
  distances("reference to mesh", *reference, *mesh, within_mm);
  distances("mesh to reference", *mesh, *reference, within_mm);
  return 0;
}

}  // namespace
}  // namespace dubsar::accuracy

int main(int argc, char** argv) {
  using namespace dubsar::accuracy;
  CLI::App app("Distance of a result from the truth", "dubsar-evaluate");
  app.require_subcommand(1);
  std::string first;
  std::string second;
  std::string truth;
  std::string conf;
  std::string unit = "mm";
  std::string gauge;
  double within_mm = 0.1;
  CLI::App* poses =
      app.add_subcommand("poses", "Poses against true or published ones, after one rigid gauge");
  poses->add_option("poses", first)->required();
  poses->add_option("scans", second, "their folder, or the session")->required();
  poses->add_option("--truth", truth);
  poses->add_option("--conf", conf);
  const CLI::IsMember is_unit = dubsar::bench::one_of(dubsar::kLengthUnits);
  poses->add_option("--unit", unit, "of the scans and the .conf")->check(is_unit);
  poses->add_option("--gauge-out", gauge);
  CLI::App* mesh = app.add_subcommand("mesh", "A mesh against a reference mesh");
  mesh->add_option("mesh", first)->required();
  mesh->add_option("reference", second)->required();
  mesh->add_option("--within", within_mm, "mm");
  mesh->add_option("--reference-unit", unit)->check(is_unit);
  mesh->add_option("--gauge", gauge);
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  if (*poses) {
    return evaluate_poses(first, second, truth, conf, dubsar::mm_per_unit(unit).value_or(1.0), gauge);
  }
  return evaluate_mesh(first, second, within_mm, unit, gauge);
}
