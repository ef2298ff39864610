// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/outward_faces.h"

#include "core/inside_out.h"
#include "core/log.h"
#include "triangulation/mesh_check.h"

namespace dubsar {

namespace {

/// A mesh that was mirrored on its way (left-handed programs) is inside out too, and its text is mirrored.
constexpr const char* kMend =
    "mend the file with dubsar mesh convert --turn-over, and look whether its signs are mirrored";
/// Of a mesh that turns into itself, as a Moebius strip does, none of the two ways is right.
constexpr const char* kMendFacesFirst =
    "some of its faces run against their neighbours: mend these first, then look again";

}  // namespace

std::optional<Error> inside_out(const Mesh& mesh, const std::string& where) {
  if (!is_inside_out(mesh)) {
    return std::nullopt;
  }
  const bool consistent = check_manifold(mesh).inconsistent_faces == 0;
  return Error{ErrorKind::kBadInput, "it is inside out: its faces look inwards", where,
               consistent ? kMend : kMendFacesFirst};
}

std::optional<Error> turned_outwards(Mesh* mesh, const std::string& where) {
  std::optional<Error> fault = inside_out(*mesh, where);
  if (fault) {
    fault->what += ", and are turned over for this";
    turn_over(mesh);
  }
  return fault;
}

void face_outwards(Mesh* mesh, const std::string& where) {
  if (const std::optional<Error> fault = turned_outwards(mesh, where)) {
    log_warning(fault->line());
  }
}

}  // namespace dubsar
