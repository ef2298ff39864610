// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar export: all that leaves the storeroom, as one checked package.

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string_view>

#include "station/command/command.h"
#include "station/command/terminal.h"
#include "station/packing.h"

namespace dubsar {

namespace {

struct ExportArguments {
  std::string session;
  std::string to;
  std::vector<std::string> without;
  std::string base_url;
  std::string ground = "black";
  bool draco = false;
  bool force = false;
  bool update = false;
};

/// RFC 3986, 3.2: of what stands between // and the next slash.
bool names_a_host(std::string_view authority) {
  std::string_view host = authority.substr(authority.find('@') + 1);  // npos + 1 is 0
  const std::size_t colon = host.find(':', host.starts_with('[') ? host.find(']') : 0);
  if (colon != std::string_view::npos) {
    const std::string_view port = host.substr(colon + 1);
    std::uint16_t number = 0;
    const auto [stop, error] = std::from_chars(port.data(), port.data() + port.size(), number);
    if (error != std::errc{} || stop != port.data() + port.size()) {
      return false;
    }
    host = host.substr(0, colon);
  }
  return host.starts_with('[') ? host.size() > 3 && host.ends_with(']')
                               : !host.empty() && host.find_first_of("[]") == std::string_view::npos;
}

/// RFC 3986, 2.1: two hexadecimal digits behind each percent sign.
bool escapes_are_whole(std::string_view url) {
  constexpr std::string_view kHex = "0123456789abcdefABCDEF";
  for (std::size_t at = url.find('%'); at != std::string_view::npos; at = url.find('%', at + 1)) {
    if (at + 2 >= url.size() || url.substr(at + 1, 2).find_first_not_of(kHex) != std::string_view::npos) {
      return false;
    }
  }
  return true;
}

/// Why nothing can be served below this address; empty where it can.
std::string fault_of_address(const std::string& url) {
  if (!url.starts_with("https://") && !url.starts_with("http://")) {
    return "an address that viewers follow begins with https:// or http://";
  }
  // RFC 3986, appendix A; names of files follow at its end.
  const bool plain = std::ranges::none_of(url, [](char c) {
    return static_cast<unsigned char>(c) <= ' ' || c == '\x7f' ||
           std::string_view("\"<>\\^`{|}?#").find(c) != std::string_view::npos;
  });
  if (!plain) {
    return "an address of a folder has no blanks, quotes, brackets, ? or #";
  }
  if (!escapes_are_whole(url)) {
    return "an address has two hexadecimal digits after each %";
  }
  std::string_view authority = url;
  authority.remove_prefix(url.find("//") + 2);
  return names_a_host(authority.substr(0, authority.find('/')))
             ? std::string()
             : "an address names a host after //, and after a colon a port up to 65535";
}

int tell_done(const ExportArguments& arguments, const CommandContext& context) {
  if (context.json) {
    CommandContext::print({{"package", arguments.to}, {"done_before", true}});
  } else {
    finish_progress();
    std::printf("%s: done before, from the same session\n", arguments.to.c_str());
  }
  return 0;
}

Result<int> export_session(const ExportArguments& arguments, CommandContext& context) {
  PackRequest request{arguments.session, arguments.to, {}, arguments.update};
  request.package.replace = arguments.force;
  request.package.base_url = arguments.base_url;
  request.package.white_ground = arguments.ground == "white";
  request.package.draco = arguments.draco;
  for (const PackagePart part : all_package_parts()) {
    if (std::ranges::find(arguments.without, to_string(part)) != arguments.without.end()) {
      request.package.without.insert(part);
    }
  }
  const Result<Packing> packing = pack_session(request, context.job);
  if (!packing) {
    return std::unexpected(packing.error());
  }
  if (packing->done_before) {
    return tell_done(arguments, context);
  }
  const Package* package = &packing->package;
  if (context.json) {
    nlohmann::ordered_json json{
        {"package", arguments.to},      {"identifier", package->identifier}, {"files", package->size.files},
        {"bytes", package->size.bytes}, {"conclusive", package->conclusive}, {"scans", package->scans},
        {"mesh", package->has_mesh},    {"wedges", package->wedges},         {"without", arguments.without}};
    if (package->kept.files > 0) {
      json["kept"] = {{"folder", package->kept.folder.string()}, {"files", package->kept.files}};
    }
    json["lacking"] = package->lacking;
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
          "where the package will be served from: ids in the IIIF manifest, annotations and provenance")
      ->check(CLI::Validator(fault_of_address, ""));
  verb->add_option("--ground", arguments->ground, "of the pictures")
      ->check(CLI::IsMember({"black", "white"}))
      ->capture_default_str();
  verb->add_flag(
      "--draco", arguments->draco,
      "add the model as glTF compressed with Draco, for sending; the plain one is there all the same");
  verb->add_flag("--force", arguments->force,
                 "replace a package of this session that lies there already, done before or not; what others "
                 "added to it is kept beside it");
  verb->add_flag(
      "--update", arguments->update,
      "replace a package that lies there already where it is whole and its stamp says that it is of "
      "an earlier state of this session");
  verb->callback([&chosen, arguments] {
    chosen = [arguments](CommandContext& c) { return export_session(*arguments, c); };
  });
}

}  // namespace dubsar
