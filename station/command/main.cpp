// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The dubsar command: a skin over the engine and the stages. Contract: design.md, "Command".

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/file_blocks.h"
#include "core/heap.h"
#include "core/log.h"
#include "core/thread_refusal.h"
#include "station/command/command.h"
#include "station/command/wrong_words.h"

namespace dubsar {

void CommandContext::print(const nlohmann::ordered_json& object) {
  finish_progress();
  std::puts(object.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace).c_str());
}

namespace {

int report(const Error& error, bool json) {
  finish_progress();
  std::fprintf(stderr, "dubsar: %s\n", error.line().c_str());
  if (json) {
    CommandContext::print(error_json(error));
  }
  return exit_status(error.kind);
}

/// Of a pipe, as `| head` does when it has what it wants.
bool has_reader_left() {
  pollfd out{STDOUT_FILENO, POLLOUT, 0};
  return poll(&out, 1, 0) == 1 && (out.revents & POLLERR) != 0;
}

/// What a verb printed is a part of what it was asked for: it has not done its work where that got lost.
Result<int> with_output_written(Result<int> status) {
  if (!status || (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) || has_reader_left()) {
    return status;
  }
  return fail(ErrorKind::kStorage, "it did not take all of the answer", "standard output",
              "free some space, or let it go elsewhere");
}

/// What is stopped deep within does not know of what.
Error told_in_full(Error error, const CLI::App& app) {
  if (error.kind == ErrorKind::kCancelled) {
    error.where = error.where.empty() ? subject_of(app) : error.where;
    error.mend = error.mend.empty() ? "give the same command again to have it done" : error.mend;
  }
  return error;
}

/// The words as the parser takes them, the last first. Of "--name=" it would take the next word for the text,
/// an option, too: there the text is empty.
std::vector<std::string> reversed_words(int argc, char** argv) {
  std::vector<std::string> words;
  bool may_be_option = true;
  for (int i = 1; i < argc; ++i) {
    std::string word = argv[i];
    may_be_option = may_be_option && word != "--";
    if (may_be_option && word.size() > 3 && word.starts_with("--") && word.find('=') == word.size() - 1) {
      word.pop_back();
      words.push_back(std::move(word));
      words.emplace_back();
    } else {
      words.push_back(std::move(word));
    }
  }
  std::ranges::reverse(words);
  return words;
}

/// In the place of a standard stream that is closed the next file or device that is opened would get what is
/// said. Opened the wrong way round it fails as a closed one does: an answer that is lost is told.
void hold_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF) {
      (void)::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    }
  }
}

int run(int argc, char** argv) {
  CLI::App app("Dubsar: the station beside a laser scanner for cuneiform tablets", "dubsar");
  app.set_version_flag("--version", DUBSAR_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->label("SUBCOMMAND", "VERB");
  app.footer(
      "Exit status: 0 done, 1 done but it falls short, 2 bad usage or input, 3 a device failed, 4 the disk "
      "refused, another program is writing there, or an internal error. Every verb has a --help of its own.");
  bool json = false;
  bool verbose = false;
  bool quiet = false;
  app.add_flag("--json", json, "Print one JSON object on standard output and nothing else there");
  app.add_flag("-v,--verbose", verbose, "Log more");
  app.add_flag("-q,--quiet", quiet, "Log warnings and errors only, no progress");
  app.fallthrough();

  Action action;
  for (const auto add : {add_drivers, add_simulate, add_calibrate, add_scan, add_register, add_plan, add_pins,
                         add_stitch, add_analyze, add_wedges, add_search, add_mesh, add_export, add_verify,
                         add_session, add_view, add_station, add_bench, add_reference}) {
    add(app, action);
  }
  try {
    app.parse(reversed_words(argc, argv));
  } catch (const CLI::Success& asked_for_help) {
    return app.exit(asked_for_help);
  } catch (const CLI::ParseError& bad) {
    // The parser may have stopped before it came to --json.
    json = json || std::find(argv, argv + argc, std::string_view("--json")) != argv + argc;
    const Error wrong{ErrorKind::kUsage, bad.what(), {}, "see dubsar --help, or dubsar VERB --help"};
    const bool left_over = dynamic_cast<const CLI::ExtrasError*>(&bad) != nullptr;
    const std::vector<std::string> rest = app.remaining(true);
    const bool option_first = !rest.empty() && rest.front().starts_with('-');
    std::optional<Error> better = option_first ? unknown_option(app) : unknown_verb(app);
    better = better ? better : option_first ? unknown_verb(app) : unknown_option(app);
    better = better || !left_over ? better : surplus_words(app);
    return report(better.value_or(wrong), json);
  }
  if (const std::optional<Error> empty = empty_option(app)) {
    return report(*empty, json);
  }
  set_log_level(verbose ? LogLevel::kDebug : quiet ? LogLevel::kWarning : LogLevel::kInfo);
  show_progress(!quiet);

  // A limit on the size of files is an error of the write, to be told in one line, not the program's end.
  std::signal(SIGXFSZ, SIG_IGN);
  CommandContext context;
  context.json = json;
  const InterruptScope interrupt(context.job);
  try {
    const Result<int> status = with_output_written(action(context));
    finish_progress();
    if (const std::size_t bytes = most_file_block_bytes(); bytes > 0) {
      log_info(fmt::format("memory was short: up to {:.1f} GiB lay in files meanwhile, which takes longer",
                           static_cast<double>(bytes) / (1U << 30U)));
    }
    return status ? *status : report(told_in_full(status.error(), app), json);
  } catch (const std::bad_alloc&) {
    return report(
        {ErrorKind::kInternal, "out of memory", {}, "close other programs or use fewer scans at once"}, json);
  } catch (const std::exception& thrown) {
    const Error defect{
        ErrorKind::kInternal, thrown.what(), {}, "this is a defect of the program: please report it"};
    return report(thread_refusal(thrown).value_or(defect), json);
  }
}

}  // namespace
}  // namespace dubsar

// What is thrown before a verb runs comes of how the verbs are declared: to end there is right.
// NOLINTNEXTLINE(bugprone-exception-escape)
int main(int argc, char** argv) {
  dubsar::hold_closed_streams();
  dubsar::map_large_blocks();
  return dubsar::run(argc, argv);
}
