// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The first page of a package: what it is, what every file of it is, and what is not in it.

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <iterator>

#include "core/scan_list.h"
#include "station/package_content.h"
#include "station/wedge_doubts.h"

namespace dubsar {

namespace {

/// Lines of at most 100 characters, indented; line breaks of the text count as blanks.
std::string folded(std::string text, std::size_t indent) {
  std::ranges::replace_if(
      text, [](char c) { return c == '\n' || c == '\r' || c == '\t'; }, ' ');
  constexpr std::size_t kWide = 100;
  std::string out;
  out.append(indent, ' ');
  std::size_t column = indent;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    if (end == at) {
      ++at;
      continue;
    }
    if (column > indent && column + 1 + (end - at) > kWide) {
      out.push_back('\n');
      out.append(indent, ' ');
      column = indent;
    } else if (column > indent) {
      out += ' ';
      ++column;
    }
    out.append(text, at, end - at);
    column += end - at;
    at = end + 1;
  }
  out.push_back('\n');
  return out;
}

/// The side that an axis of the pictures' frame belongs to in the frame that red map and report name sides
/// by.
std::string sides_sentence(const PackageContent& content) {
  if (!content.lies_by_text) {
    return "Which side is called what follows from the tablet's shape and from how it was laid down: nobody "
           "has "
           "read it for this.";
  }
  const RigidTransform& by_shape = content.source.tablet_from_model();
  const Eigen::Matrix3d shape_from_text = by_shape.rotation * content.tablet_from_model.rotation.transpose();
  constexpr double kSame = 0.7;
  if (shape_from_text(0, 0) > kSame && shape_from_text(1, 1) > kSame && shape_from_text(2, 2) > kSame) {
    return "Which side is called what follows from the direction of the wedges, and the same everywhere in "
           "this "
           "package: nobody has read the text for it.";
  }
  const auto name = [&](const Eigen::Vector3d& of_text) {
    const Eigen::Vector3d v = shape_from_text * of_text;
    Eigen::Index axis = 0;
    v.cwiseAbs().maxCoeff(&axis);
    constexpr Face kPlus[] = {Face::kRight, Face::kTop, Face::kObverse};
    constexpr Face kMinus[] = {Face::kLeft, Face::kBottom, Face::kReverse};
    return to_string(v[axis] > 0 ? kPlus[axis] : kMinus[axis]);
  };
  return fmt::format(
      "Take care: pictures, wedges and the report's table of wedges name the sides by the direction of the "
      "wedges, verdict and the rest of the report by the tablet's shape and how it was laid down, and here "
      "they differ. What pictures and wedges call the "
      "obverse, "
      "the report calls the {}; their top edge is the report's {}, their right edge its {}.",
      name(Eigen::Vector3d::UnitZ()), name(Eigen::Vector3d::UnitY()), name(Eigen::Vector3d::UnitX()));
}

/// Where the tablet's frame lies in the pictures: docs/frames-and-units.md has the rule, here are its
/// numbers.
std::string pictures_paragraph(const PackageContent& content) {
  const Mesh& mesh = content.mesh();
  Eigen::AlignedBox3d box;
  for (const auto& face : mesh.faces) {
    for (const std::uint32_t v : face) {
      box.extend(content.tablet_from_model * mesh.positions[v].cast<double>());
    }
  }
  if (content.pictures.empty() || box.isEmpty()) {
    return {};
  }
  return folded(
      fmt::format(
          "In that frame the model reaches from {:.4f} {:.4f} {:.4f} to {:.4f} {:.4f} {:.4f}; "
          "the middle of a single view above the rows of its scale bar is the middle of it. Which axis "
          "goes right and up in each view, how many rows the bar has and how a place becomes a pixel: "
          "formats/frames-and-units.txt.",
          box.min().x(), box.min().y(), box.min().z(), box.max().x(), box.max().y(), box.max().z()),
      2);
}

std::string left_out_sentence(PackagePart part) {
  switch (part) {
    case PackagePart::kGridPly:
      return "The scans are not here as PLY: it was asked to leave them out. The grids hold the same.";
    case PackagePart::kWedges:
      return "Wedges are not here, though the report may tell of files with them: it was asked to leave them "
             "out.";
    case PackagePart::kFeatures:
      return "Values by vertex are not here as text: it was asked to leave them out.";
    case PackagePart::kRenderings:
      break;
  }
  return "Pictures are not here: it was asked to leave them out.";
}

/// "wedges/annotations.json and provenance.jsonld": those that are here.
std::string files_with_addresses(const PackageContent& content) {
  std::string names;
  for (const char* path : {"iiif/manifest.json", "iiif/annotations/", "wedges/annotations.json"}) {
    if (std::ranges::find(content.files, path, &PackagedFile::path) != content.files.end()) {
      names.append(names.empty() ? "" : ", ").append(path);
    }
  }
  return names.append(names.empty() ? "" : " and ").append("provenance.jsonld");
}

}  // namespace

Status add_readme(PackageContent& content) {
  const bool conclusive = content.results().red_map.conclusive;
  std::string text;
  text.append(content.identifier)
      .append("\n")
      .append(std::string(content.identifier.size(), '='))
      .append("\n\n");
  text += folded(
      fmt::format(
          "{} packed by {} on {}. "
          "This folder is the payload of a bag (BagIt 1.0, RFC 8493): manifest-sha512.txt "
          "beside it holds the checksum of every file here, so that anybody can tell whether "
          "they are still what they were: sha512sum -c manifest-sha512.txt.",
          !content.simulated.empty() ? "SIMULATED. " + content.simulated + " This was"
          : content.comes_of_several_devices()
              ? "A cuneiform tablet, measured with several devices (scans/scans.json has that of each) and"
          : content.comes_from_files() ? "A cuneiform tablet, from files of scans,"
                                       : "A cuneiform tablet, measured by laser triangulation and",
          program_name(), content.when),
      0);
  text += "\n";
  text += folded(conclusive ? "The verdict is CONCLUSIVE: " + conclusive_words(content.results().red_map)
                            : "The verdict is NOT CONCLUSIVE: report/report.html says what is missing.",
                 0);
  text += folded("Signature: " + signature_words(content) + ".", 0);
  if (const std::string out = taken_out_in_words(content.facts.scans); !out.empty()) {
    text += folded("Taken out by the operator, and in neither model nor verdict: " + out + ".", 0);
  }
  if (content.wedges) {
    for (const Error& doubt : doubts_of(*content.wedges, {})) {
      text += folded("Take care with the wedges: " + doubt.what + ".", 0);
    }
  }
  if (const auto& unplaced = content.results().checklist.scans_unplaced; !unplaced.empty()) {
    text += folded("Without a place so far, and in neither model nor verdict: " + listed(unplaced) + ".", 0);
  }
  text += "\nTHE TABLET\n\n";
  TabletWords words = content.facts.tablet;
  if (const std::string when = scanned_in_words(content.facts.scans); !when.empty()) {
    words.emplace_back("Scanned", when);
  }
  if (!content.facts.device.empty()) {
    words.emplace_back("Scanned with", content.facts.device);
  }
  for (const auto& [label, value] : words) {
    text += folded(fmt::format("{}: {}", label, value), 2);
  }
  text += "\nTHE FILES\n\n";
  for (const PackagedFile& file : content.files) {
    text.append("  ").append(file.path).append("\n").append(folded(file.what, 6));
  }
  text += "\nFRAMES AND UNITS\n\n";
  text += folded(
      "Lengths are millimetres wherever a file does not say otherwise (GLB: metres). Scans are in the "
      "frame of the scanner as it stood for each; scans/poses.json takes each into the frame of the "
      "model. Model (in all its forms), wedges, wedges/annotations.json, red map share that frame; report "
      "and checklist give places in the tablet's. All frames: formats/frames-and-units.txt.",
      2);
  const auto rows = content.tablet_from_model.row_major();
  text +=
      "\n  The pictures lie so: tablet_from_model, row by row (x to the reader's right, y to the top edge,\n"
      "  z out of the obverse)\n";
  for (std::size_t r = 0; r < 4; ++r) {
    text += fmt::format("    {:.9g} {:.9g} {:.9g} {:.9g}\n", rows[4 * r], rows[4 * r + 1], rows[4 * r + 2],
                        rows[4 * r + 3]);
  }
  text += "\n";
  if (const std::string pictures = pictures_paragraph(content); !pictures.empty()) {
    text += pictures + "\n";
  }
  text += folded(sides_sentence(content), 2);
  if (!conclusive && !content.pictures.empty()) {
    text += folded(
        "How the tablet lies is worked out from what was scanned of it. The verdict is not conclusive: where "
        "whole sides are missing it may lie askew by some ten degrees or more in pictures and drawings, "
        "lengths in them are then too short, and its extent is not that of the tablet. What is measured on "
        "the model itself does not go by that.",
        2);
  }
  std::vector<std::string> lacking = content.lacking;
  std::ranges::copy(content.left_out, std::back_inserter(lacking));
  for (const PackagePart part : content.options.without) {
    lacking.push_back(left_out_sentence(part));
  }
  if (content.has(PackagePart::kWedges) && !content.wedges) {
    lacking.emplace_back("Wedges are not here: the model has no surface that they could be looked for on.");
  }
  if (content.wedges && content.wedges->wedges.empty()) {
    lacking.emplace_back(
        "No wedge was found on the model: the lists in wedges/ are empty, and there are no drawings.");
  }
  if (content.tablet.rights.empty()) {
    lacking.emplace_back(
        "Nobody has said whose these scans and pictures are, nor under which licence they may be used "
        "(dubsar session describe --rights): ask the collection.");
  }
  if (content.results().checklist.calibration.empty()) {
    lacking.emplace_back("The device told nothing of its calibration.");
  }
  if (content.options.base_url.starts_with("https://dubsar.invalid/")) {
    lacking.emplace_back("The addresses in " + files_with_addresses(content) + " begin with " +
                         content.options.base_url +
                         ", which nothing answers to: replace it by where this folder is served from, or "
                         "export with --base-url.");
  }
  text += "\nWHAT IS NOT HERE\n\n";
  for (const std::string& sentence : lacking) {
    text += folded(sentence, 2);
  }
  if (lacking.empty()) {
    text += "  Nothing that was measured is left out.\n";
  }
  return content.text("README.txt", text, "this page");
}

}  // namespace dubsar
