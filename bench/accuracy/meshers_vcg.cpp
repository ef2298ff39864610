// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "bench/accuracy/meshers.h"
#include "formats/mesh_io.h"

namespace dubsar::bench {

namespace {

namespace fs = std::filesystem;

/// MeshLab's own settings, with cells of µ and the result taken into the project.
void write_script(const fs::path& to, double cell_mm) {
  std::ofstream(to) << R"(<!DOCTYPE FilterScript><FilterScript><filter name="Surface Reconstruction: VCG">
<Param type="RichAbsPerc" min="0" max="100" name="voxSize" value=")"
                    << cell_mm << R"("/>
<Param type="RichInt" name="subdiv" value="1"/>
<Param type="RichFloat" name="geodesic" value="2"/>
<Param type="RichBool" name="openResult" value="true"/>
<Param type="RichInt" name="smoothNum" value="1"/>
<Param type="RichInt" name="wideNum" value="3"/>
<Param type="RichBool" name="mergeColor" value="false"/>
<Param type="RichBool" name="simplification" value="false"/>
<Param type="RichInt" name="normalSmooth" value="3"/>
</filter></FilterScript>
)";
}

std::optional<Mesh> run_vcg(const MesherInput& input) {
  std::string pattern = (fs::temp_directory_path() / "dubsar-meshers-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) {
    return std::nullopt;
  }
  const fs::path folder = pattern;
  std::string command = "cd '" + pattern + "' && QT_QPA_PLATFORM=offscreen xvfb-run -a meshlabserver";
  for (std::size_t k = 0; k < input.scans.size(); ++k) {
    const std::string name = "scan" + std::to_string(k) + ".ply";
    if (!write_mesh(folder / name, input.scans[k].mesh)) {
      return std::nullopt;
    }
    command += " -i " + name;
  }
  write_script(folder / "vcg.mlx", input.spacing_mm);
  command += " -s vcg.mlx -o merged.ply > log.txt 2>&1";
  std::optional<Mesh> out;
  if (std::system(command.c_str()) == 0) {
    if (auto mesh = read_mesh(folder / "merged.ply", {})) {
      out = std::move(*mesh);
    }
  }
  if (!out) {
    std::system(("tail -n 3 '" + (folder / "log.txt").string() + "' >&2").c_str());
  }
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  return out;
}

}  // namespace

std::vector<Mesher> vcg_meshers() {
  if (std::system("command -v meshlabserver > /dev/null 2>&1") != 0) {
    return {};
  }
  return {{"VCG's volumetric merge, cells of µ", run_vcg}};
}

}  // namespace dubsar::bench
