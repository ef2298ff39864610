// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/done_stamp.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>

#include "formats/atomic_file.h"
#include "formats/json_node.h"
#include "formats/json_text.h"
#include "formats/refusal.h"
#include "formats/xxh128.h"

namespace dubsar {

namespace fs = std::filesystem;

namespace {

Error unreadable(const fs::path& path, int number) {
  const bool missing = number == ENOENT || number == ENOTDIR || number == EISDIR;
  return {missing ? ErrorKind::kBadInput : ErrorKind::kStorage,
          std::string("cannot read: ") + std::strerror(number), path.string(),
          missing ? "check the name" : "check the disk and the rights"};
}

OrderedJson json_of(const std::vector<StampedFile>& files) {
  OrderedJson out = OrderedJson::array();
  for (const StampedFile& file : files) {
    out.push_back({{"file", file.name}, {"bytes", file.bytes}, {"xxh128", file.xxh128}});
  }
  return out;
}

std::vector<StampedFile> files_of(const JsonNode& node) {
  std::vector<StampedFile> out;
  for (const JsonNode& file : node.items()) {
    out.push_back({file.at("file").text(), file.at("bytes").unsigned_integer(), file.at("xxh128").text()});
  }
  return out;
}

/// A file that lies below the stamp's folder moves with it; any other keeps its whole name.
std::string output_name(const fs::path& output, const fs::path& folder) {
  const fs::path relative =
      fs::absolute(output).lexically_normal().lexically_relative(fs::absolute(folder).lexically_normal());
  const bool below = !relative.empty() && *relative.begin() != "..";
  return below ? relative.generic_string() : fs::absolute(output).lexically_normal().string();
}

}  // namespace

std::string done_stamp_to_json(const DoneStamp& stamp) {
  return text_of({{"program", stamp.program},
                  {"verb", stamp.verb},
                  {"parameters", stamp.parameters},
                  {"inputs", json_of(stamp.inputs)},
                  {"outputs", json_of(stamp.outputs)}});
}

Result<DoneStamp> parse_done_stamp(std::string_view text, const std::string& where) {
  const Result<JsonDocument> document = JsonDocument::parse(text, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  DoneStamp out;
  out.program = root.at("program").text();
  out.verb = root.at("verb").text();
  out.parameters = root.at("parameters").text();
  out.inputs = files_of(root.at("inputs"));
  out.outputs = files_of(root.at("outputs"));
  if (Status status = document->status("remove it: the work is then done again"); !status) {
    return std::unexpected(status.error());
  }
  return out;
}

std::optional<DoneStamp> read_done_stamp(const fs::path& stamp, std::string_view verb) {
  std::error_code error;
  const Result<std::string> text = fs::is_regular_file(stamp, error)
                                       ? read_whole_file(stamp, kMaxJsonBytes)
                                       : bad_input(stamp.string(), "not a file");
  Result<DoneStamp> known = text ? parse_done_stamp(*text, stamp.string()) : std::unexpected(text.error());
  return known && known->verb == verb ? std::optional(std::move(*known)) : std::nullopt;
}

Result<StampedFile> stamped_file(const fs::path& path, std::string name, const JobContext& job) {
  const auto close_file = [](std::FILE* file) { std::fclose(file); };
  const std::unique_ptr<std::FILE, decltype(close_file)> file(std::fopen(path.c_str(), "rb"), close_file);
  if (!file) {
    return std::unexpected(unreadable(path, errno));
  }
  Xxh128 sum;
  StampedFile out{std::move(name), 0, {}};
  std::vector<unsigned char> piece(std::size_t{1} << 20U);
  while (const std::size_t count = std::fread(piece.data(), 1, piece.size(), file.get())) {
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "stopped", path.string());
    }
    sum.add(piece.data(), count);
    out.bytes += count;
  }
  if (std::ferror(file.get()) != 0) {
    return std::unexpected(unreadable(path, errno));
  }
  out.xxh128 = sum.hex();
  return out;
}

Result<StampedWork> StampedWork::begin(fs::path stamp, std::string verb, std::string parameters,
                                       const std::vector<fs::path>& inputs, const JobContext& job,
                                       bool can_do_without_some) {
  DoneStamp made{DUBSAR_VERSION, std::move(verb), std::move(parameters), {}, {}};
  for (const fs::path& input : inputs) {
    // The folder that a tablet lies in may be mounted elsewhere on another machine: its name does not count.
    Result<StampedFile> read = stamped_file(input, input.filename().string(), job);
    if (!read && can_do_without_some && read.error().kind != ErrorKind::kCancelled) {
      read = StampedFile{input.filename().string(), 0, {}};
    }
    if (!read) {
      return std::unexpected(read.error());
    }
    made.inputs.push_back(std::move(*read));
  }
  return StampedWork(std::move(stamp), std::move(made));
}

Result<bool> StampedWork::done(const JobContext& job) const {
  const std::optional<DoneStamp> known = read_done_stamp(stamp_, made_.verb);
  if (!known || known->program != made_.program || known->parameters != made_.parameters ||
      known->inputs != made_.inputs || known->outputs.empty()) {
    return false;
  }
  std::error_code error;
  for (const StampedFile& output : known->outputs) {
    const fs::path path = stamp_.parent_path() / output.name;
    // Bytes are counted first: what was cut short need not be read.
    if (fs::file_size(path, error) != output.bytes || error) {
      return false;
    }
    const Result<StampedFile> there = stamped_file(path, output.name, job);
    if (!there && there.error().kind == ErrorKind::kCancelled) {
      return std::unexpected(there.error());
    }
    if (!there || *there != output) {
      return false;
    }
  }
  return true;
}

Status StampedWork::start() const {
  std::error_code error;
  if (!fs::remove(stamp_, error)) {
    if (!error) {
      return {};  // there was none
    }
    // A disk that is write-protected refuses to remove what is not there, too.
    std::error_code unknown;
    const bool there = fs::exists(fs::symlink_status(stamp_, unknown));
    return refused(stamp_, there ? "cannot remove the old stamp" : "cannot be written", error.value(),
                   "check the folder and its rights");
  }
  return sync_folder(folder_of(stamp_));
}

Status StampedWork::finish_staged(const std::vector<fs::path>& outputs, const fs::path& staged,
                                  const fs::path& target, const JobContext& job) const {
  DoneStamp done = made_;
  const fs::path folder = folder_of(stamp_);
  for (const fs::path& output : outputs) {
    const fs::path place = staged.empty() ? output : target / output.lexically_relative(staged);
    Result<StampedFile> written = stamped_file(output, output_name(place, folder), job);
    if (!written) {
      return std::unexpected(written.error());
    }
    done.outputs.push_back(std::move(*written));
  }
  return write_file_atomically(stamp_, done_stamp_to_json(done));
}

fs::path stamp_beside(const fs::path& output) {
  fs::path out = output;
  out += ".done";
  return out;
}

}  // namespace dubsar
