// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/job.h"
#include "core/result.h"

namespace dubsar {

/// The bytes of one file, as a stamp remembers them.
struct StampedFile {
  std::string name;  ///< as given for inputs; relative to the stamp's folder for outputs
  std::uint64_t bytes = 0;
  std::string
      xxh128;  ///< 32 hexadecimal digits, as `xxhsum -H2` prints them; empty of one that is unreadable
  bool operator==(const StampedFile&) const = default;
};

/// What one piece of work was made from, and what it gave.
struct DoneStamp {
  std::string program;     ///< version
  std::string verb;        ///< "analyze"
  std::string parameters;  ///< everything beside the inputs that decides the outputs, as one text
  std::vector<StampedFile> inputs;
  std::vector<StampedFile> outputs;
};

[[nodiscard]] std::string done_stamp_to_json(const DoneStamp& stamp);
[[nodiscard]] Result<DoneStamp> parse_done_stamp(std::string_view text, const std::string& where);
/// The stamp of that verb; nothing where none is there or it cannot be read, which is the same.
[[nodiscard]] std::optional<DoneStamp> read_done_stamp(const std::filesystem::path& stamp,
                                                       std::string_view verb);
/// A file as a stamp remembers it, under that name. Reads it once, in pieces. Errors: kBadInput, kStorage,
/// kCancelled.
[[nodiscard]] Result<StampedFile> stamped_file(const std::filesystem::path& path, std::string name,
                                               const JobContext& job);

/// Work that leaves a stamp, so that whoever starts it again finds it done: a collection can be gone through
/// by any engine, stopped anywhere and started anew. Begin before the inputs are read, ask done(), and after
/// the last output was written finish(). A stamp counts when program, verb and parameters are the same, every
/// input has the same bytes, and every output is there with the bytes that were written: everything is read
/// again, nothing is told by times. Work that is killed leaves no stamp, or one that says what is true: the
/// old stamp goes before the first output may change, the new one comes, in one step, when all are on disk.
class StampedWork {
 public:
  /// Reads the inputs. `stamp` is the stamp's own file, beside the outputs. Where the work can do without
  /// some of them, those that cannot be read are noted as such. Errors: kCancelled; kBadInput and kStorage of
  /// an input that cannot be read.
  [[nodiscard]] static Result<StampedWork> begin(std::filesystem::path stamp, std::string verb,
                                                 std::string parameters,
                                                 const std::vector<std::filesystem::path>& inputs,
                                                 const JobContext& job, bool can_do_without_some = false);

  /// Whether the stamp counts. A stamp that is not there, is damaged or belongs to other work is none.
  /// kCancelled is its only error.
  [[nodiscard]] Result<bool> done(const JobContext& job) const;
  /// Takes the old stamp away, durably: call before the first output is written.
  [[nodiscard]] Status start() const;
  /// Reads the outputs and writes the stamp. An output of the folder above or elsewhere is fine.
  [[nodiscard]] Status finish(const std::vector<std::filesystem::path>& outputs,
                              const JobContext& job) const {
    return finish_staged(outputs, {}, {}, job);
  }
  /// The same for outputs below `staged`, which is going to be renamed to `target`: the stamp is there before
  /// they are, and says what is true from that very step on.
  [[nodiscard]] Status finish_staged(const std::vector<std::filesystem::path>& outputs,
                                     const std::filesystem::path& staged, const std::filesystem::path& target,
                                     const JobContext& job) const;

  [[nodiscard]] const std::filesystem::path& stamp() const { return stamp_; }
  [[nodiscard]] const std::vector<StampedFile>& inputs() const { return made_.inputs; }

 private:
  StampedWork(std::filesystem::path stamp, DoneStamp made)
      : stamp_(std::move(stamp)), made_(std::move(made)) {}

  std::filesystem::path stamp_;
  DoneStamp made_;  ///< without outputs
};

/// "wedges.json" → "wedges.json.done": where the stamp of work with that main output lies.
[[nodiscard]] std::filesystem::path stamp_beside(const std::filesystem::path& output);

}  // namespace dubsar
