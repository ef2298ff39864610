// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar export: all that leaves the storeroom, as one checked package.

#include <algorithm>
#include <cstdio>
#include <memory>

#include "station/command/command.h"
#include "station/package.h"

namespace dubsar {

namespace {

struct ExportArguments {
  std::string session;
  std::string to;
  std::vector<std::string> without;
  std::string base_url;
  std::string ground = "black";
  bool force = false;
};

Result<int> export_session(const ExportArguments& arguments, CommandContext& context) {
  PackageOptions options;
  options.replace = arguments.force;
  options.base_url = arguments.base_url;
  options.white_ground = arguments.ground == "white";
  for (const PackagePart part : all_package_parts()) {
    if (std::ranges::find(arguments.without, to_string(part)) != arguments.without.end()) {
      options.without.insert(part);
    }
  }
  const Result<Package> package = write_package(arguments.session, arguments.to, options, context.job);
  if (!package) {
    return std::unexpected(package.error());
  }
  if (context.json) {
    nlohmann::ordered_json json{
        {"package", arguments.to},      {"identifier", package->identifier}, {"files", package->size.files},
        {"bytes", package->size.bytes}, {"conclusive", package->conclusive}, {"scans", package->scans},
        {"mesh", package->has_mesh},    {"wedges", package->wedges},         {"without", arguments.without}};
    json["timings_s"] = nlohmann::ordered_json::object();
    for (const StageTiming& timing : package->timings) {
      json["timings_s"][timing.stage] = timing.seconds;
    }
    CommandContext::print(json);
    return 0;
  }
  finish_progress();
  std::printf("%s: %s, %llu files, %s, %s\n", arguments.to.c_str(), package->identifier.c_str(),
              static_cast<unsigned long long>(package->size.files),
              size_in_words(package->size.bytes).c_str(),
              package->conclusive ? "conclusive" : "not conclusive");
  return 0;
}

}  // namespace

void add_export(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand(
      "export",
      "Everything of a session as one package (BagIt 1.0); status 0 when it is whole, whatever the "
      "verdict says");
  const auto arguments = std::make_shared<ExportArguments>();
  std::vector<std::string> parts;
  for (const PackagePart part : all_package_parts()) {
    parts.emplace_back(to_string(part));
  }
  verb->add_option("session", arguments->session, "a session folder")->required();
  verb->add_option("--to", arguments->to, "the folder to make; it appears when it is whole")->required();
  verb->add_option("--without", arguments->without, "leave out: grid-ply, wedges, features, renderings")
      ->delimiter(',')
      ->check(CLI::IsMember(parts));
  verb->add_option(
      "--base-url", arguments->base_url,
      "where the package will be served from: ids in the IIIF manifest, annotations and provenance");
  verb->add_option("--ground", arguments->ground, "of the pictures")
      ->check(CLI::IsMember({"black", "white"}))
      ->capture_default_str();
  verb->add_flag("--force", arguments->force, "replace a package that lies there already");
  verb->callback([&chosen, arguments] {
    chosen = [arguments](CommandContext& c) { return export_session(*arguments, c); };
  });
}

}  // namespace dubsar
