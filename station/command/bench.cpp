// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar bench: the benchmarks are a program of their own beside this one, so that the station links no bench
// code.

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "station/command/command.h"

namespace dubsar {

namespace {

Result<int> start_bench(const std::vector<std::string>& words, CommandContext& context) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path bench = self.parent_path() / "dubsar-bench";
  if (error || !std::filesystem::exists(bench)) {
    return fail(ErrorKind::kUsage, "the benchmarks are not installed", bench.string(),
                "build with -DDUBSAR_BENCH=ON");
  }
  std::vector<std::string> arguments{bench.string()};
  if (context.json) {
    arguments.emplace_back("--benchmark_format=json");
  }
  arguments.insert(arguments.end(), words.begin(), words.end());
  std::vector<char*> argv;
  for (std::string& argument : arguments) {
    argv.push_back(argument.data());
  }
  argv.push_back(nullptr);
  execv(bench.c_str(), argv.data());
  return fail(ErrorKind::kInternal, "the benchmarks did not start", bench.string());
}

}  // namespace

void add_bench(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand("bench", "The benchmarks, as ratios against what is named beside them");
  const auto words = std::make_shared<std::vector<std::string>>();
  verb->add_option("options", *words, "passed to Google Benchmark, e.g. -- --benchmark_filter=flags");
  verb->fallthrough();
  verb->callback(
      [&chosen, words] { chosen = [words](CommandContext& c) { return start_bench(*words, c); }; });
}

}  // namespace dubsar
