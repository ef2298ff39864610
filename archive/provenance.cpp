// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// CRMdig 4 (Doerr, Stead, Theodoridou: an extension of CIDOC CRM for provenance of digital objects). The
// classes and properties keep their numbers in their names, so that no context has to be fetched.
#include "archive/provenance.h"

#include <cmath>
#include <iterator>
#include <set>

#include "archive/file_address.h"
#include "archive/rights.h"
#include "formats/json_text.h"

namespace dubsar {

namespace {

OrderedJson reference(const std::string& id) {
  return {{"@id", id}};
}

OrderedJson references(const std::string& base_url, const std::vector<std::string>& files) {
  OrderedJson list = OrderedJson::array();
  for (const std::string& file : files) {
    list.push_back(reference(base_url + path_in_address(file)));
  }
  return list;
}

OrderedJson dimensions(const std::vector<ProvenanceValue>& values) {
  OrderedJson list = OrderedJson::array();
  for (const ProvenanceValue& value : values) {
    if (std::isfinite(value.value)) {
      OrderedJson one = {
          {"@type", "crm:E54_Dimension"}, {"rdfs:label", value.label}, {"crm:P90_has_value", value.value}};
      if (!value.unit.empty()) {
        one["crm:P91_has_unit"] = {{"@type", "crm:E58_Measurement_Unit"}, {"rdfs:label", value.unit}};
      }
      list.push_back(std::move(one));
    }
  }
  return list;
}

OrderedJson time_span(const std::string& when) {
  const OrderedJson instant = {{"@type", "xsd:dateTime"}, {"@value", when}};
  return {{"@type", "crm:E52_Time-Span"},
          {"crm:P82a_begin_of_the_begin", instant},
          {"crm:P82b_end_of_the_end", instant}};
}

/// Of a scan that was over when it was stored: nobody says when it began.
OrderedJson time_span_until(const std::string& when) {
  return {{"@type", "crm:E52_Time-Span"},
          {"rdfs:label", "stored at this time; its device told none, or none that can be"},
          {"crm:P82b_end_of_the_end", {{"@type", "xsd:dateTime"}, {"@value", when}}}};
}

OrderedJson tablet_node(const ProvenanceInput& input) {
  OrderedJson node = {{"@id", input.base_url + "tablet"},
                      {"@type", "crm:E22_Human-Made_Object"},
                      {"rdfs:label", input.identifier}};
  OrderedJson identifiers = OrderedJson::array();
  for (const auto& [kind, value] :
       {std::pair{"museum number", input.museum_number}, std::pair{"CDLI number", input.cdli}}) {
    if (!value.empty()) {
      identifiers.push_back({{"@type", "crm:E42_Identifier"},
                             {"rdfs:label", value},
                             {"crm:P2_has_type", {{"@type", "crm:E55_Type"}, {"rdfs:label", kind}}}});
    }
  }
  if (!identifiers.empty()) {
    node["crm:P1_is_identified_by"] = std::move(identifiers);
  }
  if (!input.tablet_note.empty()) {
    node["crm:P3_has_note"] = input.tablet_note;
  }
  if (!input.collection.empty()) {
    node["crm:P46i_forms_part_of"] = {{"@type", "crm:E78_Curated_Holding"}, {"rdfs:label", input.collection}};
  }
  return node;
}

/// The devices that scans name, "" among them where some name none. One: all are of the device of the pages.
std::set<std::string> devices_of(const ProvenanceInput& input) {
  std::set<std::string> devices;
  for (const ProvenanceScan& scan : input.scans) {
    devices.insert(scan.device);
  }
  return devices;
}

std::string device_id(const ProvenanceInput& input, const std::set<std::string>& devices,
                      const std::string& device) {
  const std::string id = input.base_url + "provenance/device";
  return devices.size() < 2
             ? id
             : id + "-" + std::to_string(std::distance(devices.begin(), devices.find(device)) + 1);
}

/// The device of the pages, and where scans name different ones, each of those.
void add_devices(const ProvenanceInput& input, const std::set<std::string>& devices, OrderedJson& graph) {
  OrderedJson node = {{"@id", input.base_url + "provenance/device"},
                      {"@type", "crmdig:D8_Digital_Device"},
                      {"rdfs:label", input.device.empty() ? "unknown device" : input.device}};
  if (devices.size() > 1) {
    node["crm:P3_has_note"] = "of the scan that was stored last; others are of others, as each scan says";
  }
  graph.push_back(std::move(node));
  for (const std::string& device : devices) {
    if (devices.size() > 1 && !device.empty()) {
      graph.push_back({{"@id", device_id(input, devices, device)},
                       {"@type", "crmdig:D8_Digital_Device"},
                       {"rdfs:label", device}});
    }
  }
}

OrderedJson scan_node(const ProvenanceInput& input, const std::set<std::string>& devices,
                      const ProvenanceScan& scan) {
  const std::string id = input.base_url + "provenance/scan-" + std::to_string(scan.id);
  OrderedJson node = {{"@id", id},
                      {"@type", "crmdig:D2_Digitization_Process"},
                      {"rdfs:label", "Scan " + std::to_string(scan.id)},
                      {"crmdig:L1_digitized", reference(input.base_url + "tablet")},
                      {"crm:P3_has_note", scan.note}};
  if (devices.size() < 2 || !scan.device.empty()) {
    node["crmdig:L12_happened_on_device"] = reference(device_id(input, devices, scan.device));
  }
  if (!input.operator_name.empty()) {
    node["crm:P14_carried_out_by"] = reference(input.base_url + "provenance/operator");
  }
  if (!scan.when.empty()) {
    node["crm:P4_has_time-span"] = scan.stored_only ? time_span_until(scan.when) : time_span(scan.when);
  }
  if (!scan.file.empty()) {
    node["crmdig:L20_has_created"] = {{"@id", input.base_url + path_in_address(scan.file)},
                                      {"@type", "crmdig:D9_Data_Object"}};
  }
  node["crm:P43_has_dimension"] = dimensions(scan.values);
  return node;
}

/// One node a program, named by its version where it is not the package's own.
std::string software_id(const ProvenanceInput& input, const std::string& program) {
  std::string id = input.base_url + "provenance/software";
  if (program.empty() || program == input.program) {
    return id;
  }
  id += '-';
  for (const char c : program) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.';
    id += plain ? c : '-';
  }
  return id;
}

OrderedJson software_node(const ProvenanceInput& input, const std::string& program) {
  return {{"@id", software_id(input, program)}, {"@type", "crmdig:D14_Software"}, {"rdfs:label", program}};
}

OrderedJson step_node(const ProvenanceInput& input, const ProvenanceStep& step) {
  OrderedJson node = {{"@id", input.base_url + "provenance/" + step.name},
                      {"@type", "crmdig:D3_Formal_Derivation"},
                      {"rdfs:label", step.label},
                      {"crmdig:L23_used_software_or_firmware", reference(software_id(input, step.program))},
                      {"crmdig:L21_used_as_derivation_source", references(input.base_url, step.from)},
                      {"crmdig:L22_created_derivative", references(input.base_url, step.made)}};
  if (!step.note.empty()) {
    node["crm:P3_has_note"] = step.note;
  }
  if (!step.parameters.empty()) {
    node["crmdig:L13_used_parameters"] = dimensions(step.parameters);
  }
  if (!step.results.empty()) {
    node["crm:P43_has_dimension"] = dimensions(step.results);
  }
  return node;
}

/// The signing, and who signed: two nodes. The name is what was typed, so it is nobody else's of the graph.
void add_signature(const ProvenanceInput& input, std::size_t number, OrderedJson& graph) {
  const ProvenanceSignature& signature = input.signatures[number - 1];
  const std::string id = input.base_url + "provenance/signature-" + std::to_string(number);
  OrderedJson person = {{"@id", id + "-by"}, {"@type", "crm:E21_Person"}, {"rdfs:label", signature.name}};
  if (!signature.role.empty()) {
    person["crm:P3_has_note"] = signature.role;
  }
  graph.push_back({{"@id", id},
                   {"@type", "crm:E7_Activity"},
                   {"rdfs:label", "Signing of the verdict"},
                   {"crm:P14_carried_out_by", reference(id + "-by")},
                   {"crm:P4_has_time-span", time_span(signature.when)},
                   {"crm:P16_used_specific_object", references(input.base_url, signature.of)},
                   {"crm:P3_has_note", signature.note}});
  graph.push_back(std::move(person));
}

}  // namespace

std::string provenance_jsonld(const ProvenanceInput& input) {
  OrderedJson graph =
      OrderedJson::array({{{"@id", input.base_url + "provenance.jsonld"},
                           {"@type", "crm:E31_Document"},
                           {"rdfs:label", "Provenance of the package of " + input.identifier},
                           {"crm:P70_documents", reference(input.base_url + "tablet")},
                           {"dcterms:created", {{"@type", "xsd:dateTime"}, {"@value", input.when}}}},
                          tablet_node(input)});
  if (!input.rights.empty()) {
    graph.front()["dcterms:rights"] = input.rights;
    if (const std::string address = rights_address(input.rights); !address.empty()) {
      graph.front()["dcterms:license"] = reference(address);
    }
  }
  const std::set<std::string> devices = devices_of(input);
  add_devices(input, devices, graph);
  std::set<std::string> programs{input.program};
  for (const ProvenanceStep& step : input.steps) {
    programs.insert(step.program.empty() ? input.program : step.program);
  }
  for (const std::string& program : programs) {
    graph.push_back(software_node(input, program));
  }
  if (!input.operator_name.empty()) {
    graph.push_back({{"@id", input.base_url + "provenance/operator"},
                     {"@type", "crm:E21_Person"},
                     {"rdfs:label", input.operator_name}});
  }
  if (!input.calibration.empty()) {
    OrderedJson node = {{"@id", input.base_url + "provenance/calibration"},
                        {"@type", "crm:E16_Measurement"},
                        {"rdfs:label", "Calibration of the device"},
                        {"crm:P39_measured", reference(input.base_url + "provenance/device")},
                        {"crm:P3_has_note", input.calibration}};
    if (!input.calibration_values.empty()) {
      node["crm:P40_observed_dimension"] = dimensions(input.calibration_values);
    }
    graph.push_back(std::move(node));
  }
  for (const ProvenanceScan& scan : input.scans) {
    graph.push_back(scan_node(input, devices, scan));
  }
  for (const ProvenanceStep& step : input.steps) {
    graph.push_back(step_node(input, step));
  }
  for (std::size_t number = 1; number <= input.signatures.size(); ++number) {
    add_signature(input, number, graph);
  }
  return text_of({{"@context",
                   {{"crm", "http://www.cidoc-crm.org/cidoc-crm/"},
                    {"crmdig", "http://www.ics.forth.gr/isl/CRMdig/"},
                    {"rdfs", "http://www.w3.org/2000/01/rdf-schema#"},
                    {"dcterms", "http://purl.org/dc/terms/"},
                    {"xsd", "http://www.w3.org/2001/XMLSchema#"}}},
                  {"@graph", std::move(graph)}});
}

}  // namespace dubsar
