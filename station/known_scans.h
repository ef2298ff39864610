// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "core/scan_copies.h"

namespace dubsar {

/// What a scan of a file is to a session that has scans of files already.
struct KnownAs {
  enum class Kind {
    kNew,        ///< no scan of this name is there
    kSame,       ///< it is there, or was taken out
    kOtherUnit,  ///< it stands there in another unit
    kNamesake,   ///< another scan has its name
  };
  Kind kind = Kind::kNew;
  int id = -1;            ///< of the scan that is meant
  double smaller_by = 1;  ///< kOtherUnit: how many times smaller it is in the session; below 1, larger
};

/// The scans of a session by the names of their files and by their samples, so that a file is stored once
/// however often it is read.
class KnownScans {
 public:
  using GridOf = std::function<Result<RangeGrid>(int id)>;

  /// `grid` where it was read anyway: then it is not read once more for the very same samples.
  void add(const StoredScan& scan, const RangeGrid* grid);
  /// `stored` reads a grid of the session; one that was taken out and cannot be read is told by the number of
  /// its samples.
  [[nodiscard]] KnownAs find(const RangeGrid& came, const GridOf& stored) const;

 private:
  struct One {
    int id = 0;
    std::int64_t samples = 0;
    bool dropped = false;
    std::optional<SampleDigest> digest;
  };
  std::map<std::string, std::vector<One>> by_name_;
};

/// Whether both are one measurement: the same cells, and the same samples but for the last digits of a float,
/// as another version of a reader may have them.
[[nodiscard]] bool same_samples(const RangeGrid& a, const RangeGrid& b);

/// How many times smaller `stored` is than `came` where both fill the same box but for a unit (m, cm, mm, µm,
/// inches); nothing where they do not, or the unit is the same.
[[nodiscard]] std::optional<double> unit_between(const RangeGrid& stored, const RangeGrid& came);

}  // namespace dubsar
