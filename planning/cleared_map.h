// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/placed_scan.h"
#include "planning/clearing.h"

namespace dubsar {

/// The red map's memory: which sparse samples of each registered scan every other scan clears, both ways
/// (seed 001, 3.3, step 3). Adding, moving and removing scans in any order leaves the same flags as adding
/// them all at once. Keeps pointers to the grids: they must stay alive and unmoved; the flags of an added
/// scan are copied.
class ClearedMap {
 public:
  explicit ClearedMap(ClearingOptions options = {});
  ~ClearedMap();
  ClearedMap(ClearedMap&&) noexcept;
  ClearedMap& operator=(ClearedMap&&) noexcept;
  ClearedMap(const ClearedMap&) = delete;
  ClearedMap& operator=(const ClearedMap&) = delete;

  /// A scan was registered: it is matched against all others, both ways. scan.flags are the flags of
  /// flag_sparse() or later ones (kCleared and kExcused in them are dropped). A known id is replaced.
  void add(const PlacedScan& scan);
  /// A scan lost its place (dropped, undone, unsure): what it cleared turns red again. Unknown ids are
  /// ignored.
  void remove(int id);
  /// Registration moved a scan: only its pairs are matched anew. Unknown ids are ignored.
  void reposition(int id, const RigidTransform& model_from_scanner, double sigma_mm);

  /// Where a scan lies now.
  struct NewPose {
    int id = 0;
    RigidTransform model_from_scanner;
    double sigma_mm = 0;
  };
  /// The same for many scans at once: each pair is matched anew at most once, and only when its scans have
  /// moved against each other (or its radius has changed) by more than `tolerance` µ since it was matched: a
  /// model that moves as a whole changes nothing.
  void reposition(std::span<const NewPose> poses, double tolerance);

  [[nodiscard]] bool contains(int id) const;
  /// The flags of a scan with kCleared as of now; stays valid until the scan is removed or replaced.
  /// Null for an unknown id.
  [[nodiscard]] const SampleFlags* flags(int id) const;
  /// Box around the scan's tablet samples, scanner frame; empty for an unknown id.
  [[nodiscard]] Eigen::AlignedBox3f box_mm(int id) const;
  /// All scans by ascending id, their flags pointing into this map, their noise known.
  [[nodiscard]] std::vector<PlacedScan> scans() const;
  /// For each sample of the scan's grid, the id of the lowest scan that clears it, or -1.
  [[nodiscard]] std::vector<int> cleared_by(int id) const;

 private:
  struct Entry;
  [[nodiscard]] Entry* find(int id) const;
  void match(Entry& one, Entry& two, double tolerance);

  ClearingOptions options_;
  std::vector<std::unique_ptr<Entry>> entries_;  ///< by ascending id
};

}  // namespace dubsar
