// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Replays a corpus folder and then runs deterministic mutations of it, for compilers without libFuzzer.
//   TARGET CORPUS_FOLDER RUNS            replay and mutate
//   TARGET CORPUS_FOLDER --dump K FILE   write the input of run K
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "core/random.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" void __attribute__((weak)) __sanitizer_set_death_callback(void (*callback)());

namespace {

constexpr std::size_t kMaxInputBytes = std::size_t{1} << 16U;

volatile long current_run = -1;

void say_where() {
  std::fprintf(stderr, "failed at run %ld (see --dump)\n", current_run);
}

void on_signal(int signal_number) {
  say_where();
  std::signal(signal_number, SIG_DFL);
  std::raise(signal_number);
}

std::vector<std::string> read_corpus(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path());
  }
  std::sort(names.begin(), names.end());
  std::vector<std::string> corpus;
  for (const auto& name : names) {
    std::ifstream file(name, std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return corpus;
}

void mutate_once(std::string& input, const std::vector<std::string>& corpus, dubsar::Random& random) {
  static const std::vector<std::string> kWords{
      "-1", "0",  "4294967295", "99999999999999999999", "nan", "inf", "1e308", "-0", "\n", " ", "{",
      "[",  "\"", "e"};
  static const std::vector<std::string> kBytes{
      std::string(4, '\xff'),         std::string(4, '\0'),
      std::string("\0\0\0\x80", 4),   std::string("\xff\xff\xff\x7f", 4),
      std::string("\0\0\xc0\x7f", 4), std::string(8, '\xff')};
  const std::size_t at = random.below(input.size() + 1);
  const std::size_t length = random.below(std::min<std::size_t>(input.size() - at, 64) + 1);
  switch (random.below(8)) {
    case 0:
      if (at < input.size()) {
        input[at] = static_cast<char>(input[at] ^ (1 << random.below(8)));
      }
      break;
    case 1:
      if (at < input.size()) {
        input[at] = static_cast<char>(random.below(256));
      }
      break;
    case 2:
      input.erase(at, length);
      break;
    case 3:
      input.insert(at, input.substr(at, length));
      break;
    case 4:
      input.replace(at, length, kWords[random.below(kWords.size())]);
      break;
    case 5: {
      const std::string& bytes = kBytes[random.below(kBytes.size())];
      input.replace(at, std::min(bytes.size(), input.size() - at), bytes);
      break;
    }
    case 6:
      input.resize(at);
      break;
    default: {
      const std::string& other = corpus[random.below(corpus.size())];
      input.replace(at, std::string::npos, other.substr(random.below(other.size() + 1)));
      break;
    }
  }
  input.resize(std::min(input.size(), kMaxInputBytes));
}

/// Depends on the run's number and the corpus alone.
std::string input_of(long run, const std::vector<std::string>& corpus) {
  dubsar::Random random(dubsar::seed_for(0x64756273617221ULL, static_cast<std::uint64_t>(run)));
  std::string input = corpus[random.below(corpus.size())];
  for (std::uint64_t left = 1 + random.below(6); left > 0; --left) {
    mutate_once(input, corpus, random);
  }
  return input;
}

void execute(const std::string& input) {
  // A copy of exactly this size, so that a read behind its end is seen.
  const std::vector<std::uint8_t> bytes(input.begin(), input.end());
  LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s CORPUS_FOLDER RUNS | CORPUS_FOLDER --dump K FILE\n", argv[0]);
    return 2;
  }
  const std::vector<std::string> corpus = read_corpus(argv[1]);
  if (corpus.empty()) {
    std::fprintf(stderr, "%s: no seeds\n", argv[1]);
    return 2;
  }
  if (std::string(argv[2]) == "--dump" && argc == 5) {
    std::ofstream(argv[4], std::ios::binary) << input_of(std::atol(argv[3]), corpus);
    return 0;
  }
  std::signal(SIGSEGV, on_signal);
  std::signal(SIGABRT, on_signal);
  std::signal(SIGFPE, on_signal);
  if (&__sanitizer_set_death_callback != nullptr) {
    __sanitizer_set_death_callback(say_where);
  }
  execute("");
  for (const std::string& seed : corpus) {
    execute(seed);
  }
  const long runs = std::atol(argv[2]);
  for (long run = 0; run < runs; ++run) {
    current_run = run;
    execute(input_of(run, corpus));
  }
  std::printf("%zu seeds, %ld mutations\n", corpus.size(), runs);
  return 0;
}
