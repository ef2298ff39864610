// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/known_wedge.h"
#include "core/mesh.h"
#include "core/wedge.h"

namespace dubsar {

/// Gives wedges their ids. One that lies where an earlier one lay (kSamePlaceMm) has that one's id, the
/// nearest first; any other gets an id that none ever had, in the order in which they are read. From nothing
/// the ids are therefore 0, 1, 2 and on in that order: body by body, on each the obverse, the lower edge, the
/// reverse, the upper, the left and the right edge, line by line and along the line. Deterministic.
class WedgeIds {
 public:
  /// Of ids that are there twice the first counts; those below zero or beyond kMostId are passed over.
  explicit WedgeIds(const EarlierWedges& earlier);

  /// The ids of all wedges that the mesh itself shows, in their order. To be asked once, and first. Earlier
  /// ones that may be another tablet's are forgotten where of five or more less than half lie where these do.
  [[nodiscard]] std::vector<int> of_found(const Mesh& mesh, const std::vector<Wedge>& found);
  /// The id of one that a person had a say in: that of an earlier one which came about in the same way, or of
  /// one that was measured and now had to be added.
  [[nodiscard]] int of_made(const Wedge& made);

  /// Whether that place was an earlier one's that the mesh shows no more, and not the one's that has this id:
  /// it lay nearer. To be asked after of_found().
  [[nodiscard]] bool is_of_one_gone(const Eigen::Vector3d& place_mm, int id) const;

  /// How many of the earlier ones were found where they lay, or made there anew.
  [[nodiscard]] std::size_t found_again() const { return found_again_; }
  /// They were taken for another tablet's.
  [[nodiscard]] bool forgot_earlier() const { return forgot_earlier_; }
  /// The ids that were given, ever, and that none of these has; rising, each with its last place.
  [[nodiscard]] std::vector<KnownWedge> former(const std::vector<Wedge>& left) const;

  static constexpr int kMostId = 1'000'000'000;

 private:
  void know_again(const std::vector<Wedge>& found, std::vector<int>* ids);
  void give(std::size_t known, const Wedge& wedge);
  [[nodiscard]] int give_new(const Wedge& wedge);

  std::vector<KnownWedge> known_;     ///< earlier ones by rising id, then new ones
  std::vector<KnownWedge> earlier_;   ///< the earlier ones of these where they lay
  std::vector<std::uint8_t> is_now_;  ///< [known_] one of now has the id
  bool may_be_others_ = false;
  int next_ = 0;
  std::size_t found_again_ = 0;
  bool forgot_earlier_ = false;
};

}  // namespace dubsar
