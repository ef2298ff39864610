// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <map>
#include <memory>
#include <span>
#include <vector>

#include "core/job.h"
#include "core/mesh.h"
#include "core/placed_scan.h"
#include "core/result.h"
#include "core/scan_copies.h"
#include "triangulation/fusion.h"
#include "triangulation/gap_fill.h"
#include "triangulation/grid_triangulation.h"
#include "triangulation/ownership.h"
#include "triangulation/seam_closer.h"
#include "triangulation/stitch_surface.h"

namespace dubsar {

struct StitchOptions {
  StitchSurfaceOptions surface;
  PairingOptions pairing;
  OwnershipOptions ownership;
  SeamOptions seam;
  GapFillOptions gap;
  /// Pieces with fewer faces than this are specks of dust and noise, and left out.
  int least_component_faces = 40;
};

/// Stitches placed scans into one mesh (seed 001, section 4): samples move to the reliability-weighted
/// average of themselves and their projections on the scans they pair with; each place takes its triangles
/// from its primary scan, the view closest to the normal; seams between primaries and gaps of a few samples
/// are closed. Nothing is smoothed or resampled, and nothing new is made but the interpolated vertices, which
/// are marked. The mesh is an oriented 2-manifold with boundary, whatever the scans.
///
/// Scans come one by one, in any order, and can be taken out again. add() only triangulates the scan; pairs
/// and averages are worked out by update(), or when overlaps() or mesh() asks, and anew only where something
/// has changed: those two are not for several threads at once, const as they are. The mesh depends on the set
/// of scans alone, not on the order, nor on the number of threads. Scans with the very same samples are one
/// measurement: while several are held, the one with the most samples takes part, of equals that with the
/// lowest id, and the mesh is as without the others.
class Stitcher {
 public:
  explicit Stitcher(StitchOptions options = {});
  ~Stitcher();
  Stitcher(Stitcher&&) noexcept;
  Stitcher& operator=(Stitcher&&) noexcept;
  Stitcher(const Stitcher&) = delete;
  Stitcher& operator=(const Stitcher&) = delete;

  /// Takes what it needs of the scan's grid and flags, 27 bytes a sample: they may go.
  /// Errors: kUsage when the id is there already, kBadInput when the scan has no grid, its flags have another
  /// size, its pose is not rigid or puts it too far from the origin for float; kCancelled, and then the scan
  /// is not in.
  Status add(const PlacedScan& scan, const JobContext& job);
  /// All or, on an error, those before the bad one; none of them with kCancelled.
  Status add(std::span<const PlacedScan> scans, const JobContext& job);
  /// False when there is no such scan.
  bool remove(int id);
  /// Brings pairs and averages up to date with the scans that have come and gone, so that mesh() has less to
  /// do; kCancelled is its only error, and what is done by then is not done again.
  Status update(const JobContext& job);
  /// Those held that take no part, since another has the same samples; by id.
  [[nodiscard]] std::vector<ScanCopy> copies() const;
  /// Those that take part and have no triangle, so that nothing of them is in the mesh; by id.
  [[nodiscard]] std::vector<int> without_surface() const;
  /// Two scans that overlap, and how far apart their poses hold their surfaces beyond what noise explains.
  struct Overlap {
    int id = 0, other_id = 0;
    std::size_t nodes = 0;  ///< of the lattice that hold a pair: for every sixteen samples one
    double step_mm = 0;     ///< RMS along the normal; 0 where it may be chance
    double spacing_mm = 0;  ///< the coarser
    /// Far enough apart to show in the mesh.
    [[nodiscard]] bool is_off() const { return step_mm > 0.4 * spacing_mm; }
  };
  /// Of the scans that take part.
  [[nodiscard]] std::vector<Overlap> overlaps() const;
  /// Those that do not lie where their poses put them but where the others have them, and how far that is:
  /// RMS over its surface of what shows along its normals, × √3, mm; by id.
  [[nodiscard]] std::map<int, double> moved_mm() const;
  /// The mesh of all scans, with normals, reliability, scans and flags; kCancelled is its only error, and the
  /// scans are held as before.
  [[nodiscard]] Result<Mesh> mesh(const JobContext& job) const;
  [[nodiscard]] Mesh mesh() const;
  /// The same mesh with less memory: lets go of all scans on the way, and holds none afterwards, cancelled or
  /// not.
  [[nodiscard]] Result<Mesh> take_mesh(const JobContext& job);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// All scans at once. Errors as Stitcher::add(). No scans: an empty mesh.
[[nodiscard]] Result<Mesh> stitch(std::span<const PlacedScan> scans, const StitchOptions& options,
                                  const JobContext& job);

}  // namespace dubsar
