// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The wedges of a package: every measure, a table, drawings, annotations.

#include "archive/wedge_annotations.h"
#include "archive/wedge_drawing.h"
#include "archive/wedge_table.h"
#include "formats/wedges_json.h"
#include "station/package_content.h"

namespace dubsar {

Status add_wedges(PackageContent& content) {
  if (!content.wedges) {
    return {};  // add_readme() says why
  }
  WedgeFile file = *content.wedges;
  file.label = content.label;
  file.mesh = "../model/" + content.stem + ".ply";
  file.timings_s.clear();
  for (const Status& written :
       {content.text("wedges/wedges.json", wedges_to_json(file),
                     "every measure of every wedge, with its uncertainty: formats/wedges.txt"),
        content.text("wedges/wedges.csv", wedge_table(file.wedges, file.label),
                     "the same as a table, one line a wedge; millimetres and degrees; its columns: "
                     "formats/wedges.txt"),
        content.text("wedges/annotations.json",
                     wedge_annotations(file.wedges, {.base_url = content.options.base_url,
                                                    .page = "wedges/annotations.json",
                                                    .model = "model/" + content.stem + ".ply",
                                                    .identifier = content.identifier,
                                                    .program = program_name(),
                                                    .when = content.when,
                                                    .rights = content.tablet.rights,
                                                    .simulated = content.simulated}),
                     "the wedges as W3C Web Annotations: the triangle of its outer edges on the model, "
                     "millimetres, as WKT POLYGON Z")}) {
    if (!written) {
      return written;
    }
  }
  if (file.text_from_model && !file.wedges.empty()) {
    const auto drawings =
        write_wedge_drawings(content.root / "wedges" / "drawings", file.wedges, *file.text_from_model,
                             picture_words(content.label, content.identifier), &content.mesh());
    if (!drawings) {
      return std::unexpected(drawings.error());
    }
    content.list("wedges/drawings/",
                 "a drawing of each inscribed side as it is read, to scale (SVG 1.1, millimetres): "
                 "formats/frames-and-units.txt");
  }
  return {};
}

}  // namespace dubsar
