// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "archive/bag.h"
#include "archive/kept_files.h"
#include "archive/report.h"
#include "core/job.h"
#include "core/result.h"
#include "core/stage_times.h"

namespace dubsar {

/// What may be left out of a package.
enum class PackagePart {
  kGridPly,     ///< the scans as PLY beside their own form
  kWedges,      ///< wedges: table, drawings, annotations
  kFeatures,    ///< values by vertex
  kRenderings,  ///< pictures of the tablet, and the manifest that lists them
};
/// "grid-ply", "wedges", "features", "renderings"
[[nodiscard]] std::string_view to_string(PackagePart part);
[[nodiscard]] const std::vector<PackagePart>& all_package_parts();

struct PackageOptions {
  std::set<PackagePart> without;
  bool replace = false;  ///< a package that lies there already; what others added to it is kept beside
  /// Where the pictures will be served: the ids of the IIIF manifest and of the annotations begin with it.
  /// Empty: a name under `.invalid`, which nothing answers to.
  std::string base_url;
  bool white_ground = false;  ///< of the pictures, instead of black
  bool draco = false;         ///< the model compressed, too: model/STEM.draco.glb
  /// Called with the whole, synced folder just before it takes its place; what it refuses is not published.
  std::function<Status(const std::filesystem::path& staged)> before_publishing;
};

/// Where a package has the session's events, below its payload's folder.
inline constexpr const char* kPackedEvents = "session/events.json";

/// What was written.
struct Package {
  std::filesystem::path folder;
  BagSize size;
  KeptFiles kept;          ///< of the package that was replaced: what was not its own
  std::string identifier;  ///< CDLI number, museum number or name of the session
  bool conclusive = false;
  bool has_mesh = false;
  std::size_t scans = 0;  ///< whole grids, those taken out included
  std::size_t wedges = 0;
  std::vector<std::string> lacking;  ///< what is not in it and why, one sentence each
  StageTimes timings;
};

/// Writes everything that leaves the storeroom into one folder, a BagIt 1.0 bag (docs/archives/package.md).
/// What the session lacks (mesh, wedges) is worked out by the stages that the station uses itself; the
/// session is only read. The folder appears when it is whole, or not at all. The verdict does not matter:
/// what is there is packed, without a model where no scan can be read. `to` is a resolved_place(). Errors:
/// kUsage where something lies at `to` already (or, with `replace`, something that is no package of Dubsar,
/// or of another session) or `session` is none, kBadInput, kStorage, kCancelled.
[[nodiscard]] Result<Package> write_package(const std::filesystem::path& session,
                                            const std::filesystem::path& to, const PackageOptions& options,
                                            JobContext& job);

}  // namespace dubsar
