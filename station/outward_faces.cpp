// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/outward_faces.h"

#include "core/inside_out.h"
#include "core/log.h"

namespace dubsar {

namespace {

/// A mesh that was mirrored on its way (left-handed programs) is inside out too, and its text is mirrored.
constexpr const char* kMend =
    "mend the file with dubsar mesh convert --turn-over, and look whether its signs are mirrored";

}  // namespace

std::optional<Error> inside_out(const Mesh& mesh, const std::string& where) {
  if (!is_inside_out(mesh)) {
    return std::nullopt;
  }
  return Error{ErrorKind::kBadInput, "it is inside out: its faces look inwards", where, kMend};
}

void face_outwards(Mesh* mesh, const std::string& where) {
  if (std::optional<Error> fault = inside_out(*mesh, where)) {
    fault->what += ", and are turned over for this";
    log_warning(fault->line());
    turn_over(mesh);
  }
}

}  // namespace dubsar
