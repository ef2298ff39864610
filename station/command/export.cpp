// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar export: all that leaves the storeroom, as one checked package.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include "acquisition/session_store.h"
#include "formats/atomic_file.h"
#include "formats/json_node.h"
#include "station/command/command.h"
#include "station/command/outputs.h"
#include "station/command/terminal.h"
#include "station/done_stamp.h"
#include "station/earlier_package.h"
#include "station/package.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

struct ExportArguments {
  std::string session;
  std::string to;
  std::vector<std::string> without;
  std::string base_url;
  std::string ground = "black";
  bool force = false;
  bool update = false;
};

/// Every file below a folder but those to be passed over, in order.
Result<std::vector<fs::path>> files_below(const fs::path& folder,
                                          const std::function<bool(const fs::path&)>& passes_over) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (passes_over(at->path())) {
      at.disable_recursion_pending();
    } else if (at->is_regular_file(error)) {
      files.push_back(at->path());
    }
  }
  if (error) {
    return fail(ErrorKind::kStorage, error.message(), folder.string(), "look at its rights");
  }
  std::ranges::sort(files);
  return files;
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
  return plain ? std::string() : "an address of a folder has no blanks, quotes, brackets, ? or #";
}

/// What decides what is in the package, beside the session.
std::string parameters_of(const ExportArguments& arguments) {
  nlohmann::ordered_json json{{"base_url", arguments.base_url}, {"ground", arguments.ground}};
  std::vector<std::string> without = arguments.without;
  std::ranges::sort(without);
  json["without"] = without;
  return json.dump();
}

/// The folder to make, whole and without a slash at its end: its stamp lies beside it.
fs::path target_of(const ExportArguments& arguments) {
  const fs::path target = fs::absolute(arguments.to).lexically_normal();
  return target.has_filename() ? target : target.parent_path();
}

/// A package that is made again from the same session is found done (docs/collections.md).
Result<StampedWork> begin_work(const ExportArguments& arguments, const JobContext& job) {
  const fs::path target = target_of(arguments);
  const auto passes_over = [&](const fs::path& file) {
    const std::string name = file.filename().string();
    const fs::path normal = fs::absolute(file).lexically_normal();
    return normal == target || normal == stamp_beside(target) || name == "session.lock" ||
           name.ends_with("-shm") || name.starts_with(kTemporaryPrefix);
  };
  const Result<std::vector<fs::path>> inputs = files_below(arguments.session, passes_over);
  if (!inputs) {
    return std::unexpected(inputs.error());
  }
  return StampedWork::begin(stamp_beside(target), "export", parameters_of(arguments), *inputs, job);
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

/// The stamp as it lies there; empty where none does.
std::string stamp_text(const StampedWork& work) {
  std::error_code none;
  const Result<std::string> text = fs::is_regular_file(work.stamp(), none)
                                       ? read_whole_file(work.stamp(), kMaxJsonBytes)
                                       : Result<std::string>();
  return text.value_or(std::string());
}

/// Nothing was done: the stamp says again what it said before, for what lies there is what lay there.
void take_back(const StampedWork& work, const std::string& before) {
  if (before.empty() || !write_file_atomically(work.stamp(), before)) {
    (void)work.start();  // a stamp that stays all the same fits nothing that is there
  }
}

Result<int> export_session(const ExportArguments& arguments, CommandContext& context) {
  std::error_code ignored;
  std::optional<StampedWork> work;
  bool replace = arguments.force;
  if (SessionStore::is_session(arguments.session)) {
    Result<StampedWork> begun = begin_work(arguments, context.job);
    if (!begun) {
      return std::unexpected(begun.error());
    }
    work = std::move(*begun);
    const Result<bool> done = arguments.force ? false : work->done(context.job);
    if (!done) {
      return std::unexpected(done.error());
    }
    if (*done) {
      return tell_done(arguments, context);
    }
    // Whatever is replaced keeps its stamp until the new one is whole.
    if (!fs::exists(arguments.to, ignored)) {
      if (const Status started = work->start(); !started) {
        return std::unexpected(started.error());
      }
    } else if (arguments.update && !replace) {
      const Result<bool> earlier = is_earlier_package(target_of(arguments), *work, context.job);
      if (!earlier) {
        return std::unexpected(earlier.error());
      }
      replace = *earlier;
    }
  }
  PackageOptions options;
  options.replace = replace;
  options.base_url = arguments.base_url;
  options.white_ground = arguments.ground == "white";
  for (const PackagePart part : all_package_parts()) {
    if (std::ranges::find(arguments.without, to_string(part)) != arguments.without.end()) {
      options.without.insert(part);
    }
  }
  bool stamped = false;
  const std::string before = work ? stamp_text(*work) : std::string();
  if (work) {
    options.before_publishing = [&](const fs::path& staged) -> Status {
      const auto outputs = files_below(staged, [](const fs::path&) { return false; });
      if (!outputs) {
        return std::unexpected(outputs.error());
      }
      stamped = true;
      return work->finish_staged(*outputs, staged, target_of(arguments), context.job);
    };
  }
  const Result<Package> package = write_package(arguments.session, arguments.to, options, context.job);
  if (!package) {
    if (stamped) {
      take_back(*work, before);
    }
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
          "where the package will be served from: ids in the IIIF manifest, annotations and provenance")
      ->check(CLI::Validator(fault_of_address, ""));
  verb->add_option("--ground", arguments->ground, "of the pictures")
      ->check(CLI::IsMember({"black", "white"}))
      ->capture_default_str();
  verb->add_flag("--force", arguments->force,
                 "replace a package that lies there already, done before or not");
  verb->add_flag(
      "--update", arguments->update,
      "replace a package that lies there already where it is whole and its stamp says that it is of "
      "an earlier state of this session");
  verb->callback([&chosen, arguments] {
    chosen = outside_sessions({arguments->to},
                              [arguments](CommandContext& c) { return export_session(*arguments, c); });
  });
}

}  // namespace dubsar
