// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar export: what it writes, read by other people's programs.

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "build_paths.h"
#include "tests/station/support/exported.h"
#include "tests/station/support/shell.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::has_program;
using test::quoted;
using test::shell;

TEST_F(Export, OthersReadItsForms) {
  if (!has_program("qpdf") || !has_program("pdfinfo") || !has_program("pdffonts")) {
    FAIL() << "install qpdf and poppler-utils (packages.txt) to hold the files against them";
  }
  const std::string pdf = quoted(data("report/report.pdf"));
  EXPECT_EQ(shell("qpdf --check " + pdf), 0);
  EXPECT_EQ(shell("pdfinfo " + pdf + " | grep -q 'Page size: *595.* x 841.*A4'"), 0);
  // From the third line on: name, type, encoding, embedded.
  EXPECT_EQ(shell("pdffonts " + pdf + " | tail -n +3 | grep -vq ' yes yes yes '"), 1)
      << "every font is embedded, as a subset, with its letters";
  EXPECT_EQ(shell("pdftotext " + pdf + " - | grep -q 'Not conclusive'"), 0);
  EXPECT_EQ(shell("qpdf --json --json-key=outlines " + pdf + " | grep -q '\"title\": \"Checklist\"'"), 0)
      << "its headings are its outline";
}

TEST_F(Export, TheReportIsForArchives) {
  const std::string check =
      "sh " + quoted(fs::path(DUBSAR_SOURCE_DIR) / "tests/support/check_pdf_a.sh") + " ";
  EXPECT_EQ(shell(check + quoted(data("report/report.pdf"))), 0)
      << "PDF/A-1b; to be held against it needs Java and PDFBox's Preflight (packages.txt)";
}

TEST_F(Export, TheBagHoldsToTheStandardByAnotherReading) {
  const std::string check =
      "/usr/bin/python3 " + quoted(fs::path(DUBSAR_SOURCE_DIR) / "tests/station/support/check_bag.py") + " ";
  EXPECT_EQ(shell(check + quoted(at("bag"))), 0);
  // It does find faults.
  const fs::path bag = at("faulty");
  ASSERT_EQ(export_to("faulty", {"--without", "renderings,features,wedges,grid-ply"}).status, 0);
  EXPECT_EQ(shell(check + quoted(bag)), 0);
  for (const char* name :
       {"data/README.txt", "bag-info.txt", "data/new.txt", "bagit.txt", "manifest-sha512.txt"}) {
    const bool is_new = !fs::exists(bag / name);
    const std::string before = is_new ? std::string() : bytes_of(bag / name);
    std::ofstream(bag / name, std::ios::app) << "a line more\n";
    EXPECT_EQ(shell(check + quoted(bag)), 1) << name;
    std::ofstream(bag / name, std::ios::binary) << before;
    if (is_new) {
      fs::remove(bag / name);
    }
  }
  EXPECT_EQ(shell(check + quoted(bag)), 0);
}

TEST_F(Export, TheAccessMeshesAreValidGltf) {
  // Khronos' own validator, from npm; Debian has none. ./test puts it there (tools/ensure-validators).
  const std::string node =
      "NODE_PATH=\"$NODE_PATH:" DUBSAR_BINARY_DIR "/../validators/node_modules\" node -e ";
  if (std::system((node + "\"require('gltf-validator')\" 2>/dev/null").c_str()) != 0) {
    GTEST_SKIP() << "tools/ensure-validators brings gltf-validator, where npm can be had";
  }
  const std::string check =
      node +
      "\"require('gltf-validator').validateBytes(new Uint8Array(require('fs').readFileSync("
      "process.argv[1]))).then(r => { console.error(JSON.stringify(r.issues)); "
      "process.exit(r.issues.numErrors + r.issues.numWarnings > 0 ? 1 : 0); })\" ";
  EXPECT_EQ(shell(check + quoted(data("model/session.glb"))), 0);
  // Of the compressed one it sees all but what Draco packed, which it says it does not look into.
  const fs::path packed = at("valid.draco.glb");
  ASSERT_EQ(
      test::run_command({"mesh", "convert", data("model/session.ply").string(), packed.string()}).status, 0);
  EXPECT_EQ(shell(check + quoted(packed)), 0);
}

TEST_F(Export, LinkedDataHasTheShapeOfTheStandards) {
  const std::string python = "/usr/bin/python3";
  if (std::system((python + " -c 'import jsonschema' 2>/dev/null").c_str()) != 0) {
    FAIL() << "install python3-jsonschema (packages.txt) to hold the files against schemas";
  }
  for (const auto& [file, schema] : {std::pair{"iiif/manifest.json", "iiif_manifest.json"},
                                     std::pair{"wedges/annotations.json", "annotation_page.json"},
                                     std::pair{"provenance.jsonld", "provenance.json"}}) {
    const std::string check =
        " -c 'import json, jsonschema, sys; "
        "jsonschema.validate(json.load(open(sys.argv[1])), json.load(open(sys.argv[2])))' ";
    const fs::path shape = fs::path(DUBSAR_SOURCE_DIR) / "tests/station/schemas" / schema;
    EXPECT_EQ(shell(python + check + quoted(data(file)) + " " + quoted(shape)), 0) << file;
  }
}

TEST_F(Export, ProvenanceIsAGraphToOthers) {
  if (std::system("/usr/bin/python3 -c 'import rdflib' 2>/dev/null") != 0) {
    FAIL() << "install python3-rdflib (packages.txt) to read the provenance as linked data";
  }
  // Every file that a scan created is the source of a step.
  const std::string check =
      "/usr/bin/python3 -c 'import rdflib, sys; g = rdflib.Graph(); g.parse(sys.argv[1], "
      "format=\"json-ld\"); "
      "d = rdflib.Namespace(\"http://www.ics.forth.gr/isl/CRMdig/\"); "
      "made = set(g.objects(None, d[\"L20_has_created\"])); "
      "used = set(g.objects(None, d[\"L21_used_as_derivation_source\"])); "
      "sys.exit(0 if len(made) == 3 and made <= used else 1)' ";
  EXPECT_EQ(shell(check + quoted(data("provenance.jsonld"))), 0);
}

}  // namespace
}  // namespace dubsar
