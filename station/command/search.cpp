// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar search: similar wedges and similar tablets over a collection of analysed ones.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "core/log.h"
#include "core/number_text.h"
#include "station/collection.h"
#include "station/command/command.h"
#include "station/command/option_checks.h"

namespace dubsar {

namespace {

struct SearchArguments {
  std::string folder;
  std::string like;
  int wedge = -1;
  int count = 10;
};

// What is just like the one that is asked for is it, or a copy of it.
constexpr const char* kNoOtherWedge = "there is no other wedge to compare it with, but copies of it";
constexpr const char* kNoOtherTablet =
    "there is no other tablet to compare it with, but copies of it or those with fewer than five wedges";

std::string method_words(int method) {
  return method > 0 ? fmt::format("method {}", method) : std::string("a method that is not said");
}

void warn_of_methods(const SearchArguments& arguments, int method, const OtherMethods& otherwise) {
  if (otherwise.first == nullptr) {
    return;
  }
  log_warning(
      Error{ErrorKind::kBadInput,
            fmt::format("{} of {} tablets that are searched were measured in another way than {} ({}): "
                        "{} for one ({}); one and the same wedge may then be half a unit from itself",
                        otherwise.others, otherwise.searched, arguments.like, method_words(method),
                        otherwise.first->name, method_words(otherwise.first->method)),
            arguments.folder, "measure all with one version of dubsar analyze"}
          .line());
}

Result<int> search(const SearchArguments& arguments, CommandContext& context) {
  const Result<WedgeFile> like = read_compared_wedges(arguments.like);
  if (!like) {
    return std::unexpected(like.error());
  }
  const Result<Collection> collection = Collection::open(arguments.folder);
  if (!collection) {
    return std::unexpected(collection.error());
  }
  if (!collection->remark().empty()) {
    log_warning(collection->remark());
  }
  for (const UnreadPlace& place : collection->unread()) {
    log_warning(
        fmt::format("left out: {} in {} cannot be read: {}", place.name, arguments.folder, place.reason));
  }
  for (const std::string& session : collection->lost_sessions()) {
    log_warning(
        fmt::format("left out: {} in {} is a session without its session.sqlite, and has no wedges; dubsar "
                    "verify --repair makes the one anew, dubsar analyze the others",
                    session, arguments.folder));
  }
  std::size_t of_another_kind = 0;
  for (const IndexedTablet& file : collection->files()) {
    if (file.complaint == kNoWedgesJson) {
      ++of_another_kind;
    } else if (!file.complaint.empty()) {
      log_warning("left out: " + file.complaint);
    }
  }
  if (of_another_kind > 0) {
    log_debug(fmt::format("{} .json files hold no wedges: passed over", of_another_kind));
  }
  const OtherMethods otherwise = collection->measured_otherwise(like->method);
  warn_of_methods(arguments, like->method, otherwise);
  nlohmann::ordered_json json{{"collection", arguments.folder},
                              {"files", collection->files().size()},
                              {"read_anew", collection->read_anew()},
                              {"of_another_method", otherwise.others},
                              {"like", arguments.like}};
  const auto count = static_cast<std::size_t>(arguments.count);
  if (arguments.wedge >= 0) {
    const auto wedge = std::ranges::find(like->wedges, arguments.wedge, &Wedge::id);
    if (wedge == like->wedges.end()) {
      return fail(ErrorKind::kUsage, "there is no wedge " + std::to_string(arguments.wedge), arguments.like,
                  "give one of the ids in it");
    }
    json["wedge"] = arguments.wedge;
    json["wedges"] = nlohmann::ordered_json::array();
    for (const SimilarWedge& s : collection->similar_wedges(*wedge, count)) {
      json["wedges"].push_back({{"tablet", s.tablet}, {"id", s.wedge}, {"distance", s.distance}});
      if (!context.json) {
        std::printf("%8.3f  %s  wedge %d\n", s.distance, s.tablet.c_str(), s.wedge);
      }
    }
  } else {
    if (like->wedges.size() < kFewestWedges) {
      return fail(ErrorKind::kUsage,
                  fmt::format("it has {} to search by, and tablets are compared from {} on",
                              like->wedges.empty() ? "no wedges" : counted(like->wedges.size(), "wedge"),
                              kFewestWedges),
                  arguments.like, "choose another tablet, or search by one of its wedges with --wedge");
    }
    json["tablets"] = nlohmann::ordered_json::array();
    for (const SimilarTablet& s : collection->similar_tablets(*like, count)) {
      json["tablets"].push_back({{"tablet", s.tablet}, {"wedges", s.wedges}, {"distance", s.distance}});
      if (!context.json) {
        std::printf("%8.3f  %s  %d wedges\n", s.distance, s.tablet.c_str(), s.wedges);
      }
    }
  }
  if (context.json) {
    CommandContext::print(json);
  }
  const bool of_wedges = arguments.wedge >= 0;
  if (json[of_wedges ? "wedges" : "tablets"].empty()) {
    log_warning(Error{ErrorKind::kBadInput, of_wedges ? kNoOtherWedge : kNoOtherTablet, arguments.folder,
                      "search a folder with more tablets"}
                    .line());
  }
  return 0;
}

}  // namespace

void add_search(CLI::App& app, Action& chosen) {
  CLI::App* verb =
      app.add_subcommand("search", "Similar wedges and tablets over a collection, nearest first");
  const auto arguments = std::make_shared<SearchArguments>();
  verb->add_option("folder", arguments->folder, "of analysed tablets: the wedges of each at or below it")
      ->required();
  verb->add_option("--like", arguments->like, "the wedges.json to search by")->required();
  verb->add_option("--wedge", arguments->wedge, "search for this wedge of it; otherwise for tablets like it")
      ->check(not_negative());
  verb->add_option("--count", arguments->count, "how many to show")
      ->check(in_range(1, 100000))
      ->capture_default_str();
  verb->callback(
      [&chosen, arguments] { chosen = [arguments](CommandContext& c) { return search(*arguments, c); }; });
}

}  // namespace dubsar
