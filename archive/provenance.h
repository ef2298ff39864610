// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

namespace dubsar {

/// A value with its unit, such as {"registration RMS", 0.012, "mm"}.
struct ProvenanceValue {
  std::string label;
  double value = 0;
  std::string unit;
};

/// One scan: the digitisation of a part of the tablet.
struct ProvenanceScan {
  int id = 0;
  std::string when;  ///< ISO 8601, or empty
  std::string file;  ///< the raw grid, relative to base_url
  std::string note;  ///< what became of it: "registered", or why it was taken out
  bool in_model = false;
  std::vector<ProvenanceValue> values;
  bool stored_only = false;  ///< `when` it was stored: its device told no time
  std::string device{};      ///< as the scan itself names it, or empty
};

/// A name under the verdict.
struct ProvenanceSignature {
  std::string name;             ///< of the person
  std::string role;             ///< or empty
  std::string when;             ///< ISO 8601
  std::string note;             ///< what was signed, and whether it holds
  std::vector<std::string> of;  ///< files, relative to base_url
};

/// One step of computing: files made of files by a program.
struct ProvenanceStep {
  std::string name;  ///< for the id: "stitching"
  std::string label;
  std::vector<std::string> from;  ///< relative to base_url
  std::vector<std::string> made;
  std::vector<ProvenanceValue> parameters;
  std::vector<ProvenanceValue> results;  ///< errors and counts
  std::string program{};                 ///< that did it; empty: the one that made the package
  std::string note{};                    ///< in words, or empty
};

struct ProvenanceInput {
  std::string base_url;  ///< ends with a slash
  std::string identifier;
  std::string museum_number;
  std::string cdli;
  std::string collection;
  std::string tablet_note{};  ///< what else has to be known of the tablet, or empty
  std::string operator_name;
  std::string rights{};     ///< in words, or empty
  std::string device;       ///< of the scan that was stored last
  std::string program;      ///< "Dubsar 0.1.0"
  std::string when;         ///< ISO 8601, of the package
  std::string calibration;  ///< in words; empty when the device told none
  std::vector<ProvenanceValue> calibration_values;
  std::vector<ProvenanceScan> scans;
  std::vector<ProvenanceStep> steps;
  std::vector<ProvenanceSignature> signatures{};
};

/// How every file came about, as JSON-LD with the terms of CIDOC CRM and CRMdig: the tablet, the device and
/// its calibration, each scan, each step of computing with its parameters, errors and software. Where scans
/// name different devices each happened on its own, which has a node by that name; those that name none on
/// none.
[[nodiscard]] std::string provenance_jsonld(const ProvenanceInput& input);

}  // namespace dubsar
