// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/bag_check.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "formats/atomic_file.h"
#include "formats/bag_doubt.h"
#include "formats/digest.h"
#include "formats/files_below.h"

namespace dubsar {

namespace fs = std::filesystem;

namespace {

constexpr const char* kDeclaration = "bagit.txt";
constexpr const char* kMend = "get the bag again from its source";
constexpr const char* kMendExtra = "see what it is, and take it out of data/";
constexpr const char* kMendLine =
    "get this list again from its source, or from a copy (dubsar verify --repair --from COPY)";
constexpr const char* kNoneLists = "no manifest lists it";
constexpr const char* kNotAllList = "not every manifest lists it";

bool is_payload(const std::string& name) {
  return name.starts_with("data/");
}

/// "sha512" of "manifest-sha512.txt"; empty for other names.
std::string algorithm_of(const std::string& name, const std::string& prefix) {
  constexpr std::string_view kEnd = ".txt";
  return name.starts_with(prefix) && name.ends_with(kEnd) && name.size() > prefix.size() + kEnd.size()
             ? name.substr(prefix.size(), name.size() - prefix.size() - kEnd.size())
             : std::string();
}

class Check {
 public:
  Check(const fs::path& folder, JobContext& job) : folder_(folder), job_(job) {}

  Result<BagReport> run() {
    list_files("");
    read_declaration();
    std::error_code ignored;
    if (!is_hidden("data") && !fs::is_directory(folder_ / "data", ignored)) {
      say("data", "missing: a bag has its payload there");
    }
    const std::vector<BagManifest> payload = manifests("manifest-");
    const std::vector<BagManifest> tags = manifests("tagmanifest-");
    const bool lists = std::ranges::any_of(files_, [](const std::string& name) {
      return digest_named(algorithm_of(name, "manifest-")).has_value();
    });
    if (!lists && !is_hidden("manifest-sha512.txt")) {
      say("manifest-sha512.txt",
          "missing: without a manifest of SHA-2, SHA-1 or MD5 nothing can be checked here");
    }
    for (const BagManifest& manifest : payload) {
      report_.algorithms.push_back(manifest.algorithm);
    }
    check_listing(payload, tags);
    check_info();
    if (const Status summed = check_sums(payload, tags); !summed) {
      return std::unexpected(summed.error());
    }
    return std::move(report_);
  }

 private:
  void say(const std::string& where, const std::string& what, const std::string& mend = kMend) {
    report_.damaged.push_back({ErrorKind::kBadInput, what, where, mend});
  }

  /// Of a bag whose declaration is lost the rest is checked as today's version has it: what is whole is to be
  /// told all the same.
  void read_declaration() {
    const std::optional<std::string> text = text_of(kDeclaration);
    if (!text) {
      return;
    }
    const Result<BagDeclaration> declared = parse_bag_declaration(*text, kDeclaration);
    if (!declared) {
      report_.damaged.push_back(declared.error());
      return;
    }
    declaration_ = *declared;
    report_.version = std::to_string(declaration_.major) + "." + std::to_string(declaration_.minor);
  }

  /// All below a folder of the bag; its name ends with '/', the bag's own is empty.
  void list_files(const std::string& below) {
    if (const Status readable = check_folder_can_be_read(folder_ / below); !readable) {
      cannot_list(below, readable.error().what, readable.error().mend);
      return;
    }
    std::error_code error;
    std::error_code ignored;
    fs::directory_iterator it(folder_ / below, error);
    for (const fs::directory_iterator end; !error && it != end; it.increment(error)) {
      const std::string name = below + it->path().filename().string();
      if (it->is_symlink(ignored)) {
        say(name, "a link: a bag holds its files itself");
        missing_.insert(name);
      } else if (it->is_regular_file(ignored)) {
        files_.insert(name);
      } else if (it->is_directory(ignored)) {
        list_files(name + "/");
      } else {
        say(name, "neither a file nor a folder");
      }
    }
    if (error) {
      cannot_list(below, "cannot read the folder: " + error.message(), "look at its rights and at the disk");
    }
  }

  void cannot_list(const std::string& below, const std::string& what, const std::string& mend) {
    say(below.empty() ? folder_.string() : below, what, mend);
    hidden_.push_back(below);
  }

  /// Whether it lies where nobody can tell what is there: that was said once, of the folder.
  [[nodiscard]] bool is_hidden(const std::string& name) const {
    return std::ranges::any_of(hidden_, [&](const std::string& below) { return name.starts_with(below); });
  }

  std::optional<std::string> text_of(const std::string& name) {
    if (!files_.contains(name)) {
      if (missing_.insert(name).second && !is_hidden(name)) {
        say(name, "missing");
      }
      return std::nullopt;
    }
    Result<std::string> text = read_whole_file(folder_ / name, kMaxBagTextBytes);
    if (!text) {
      say(name, text.error().what);
      return std::nullopt;
    }
    return std::move(*text);
  }

  std::vector<BagManifest> manifests(const std::string& prefix) {
    std::vector<BagManifest> out;
    for (const std::string& name : files_) {
      const std::string algorithm = algorithm_of(name, prefix);
      if (algorithm.empty()) {
        continue;
      }
      const std::optional<Digest> digest = digest_named(algorithm);
      if (!digest) {
        report_.unchecked.push_back(name);
        continue;
      }
      const std::optional<std::string> text = text_of(name);
      if (!text) {
        continue;
      }
      Result<std::vector<BagManifestLine>> lines = parse_bag_manifest(*text, declaration_, name);
      if (!lines) {
        report_.damaged.push_back(lines.error());
        continue;
      }
      out.push_back({name, algorithm, *digest, std::move(*lines)});
    }
    return out;
  }

  /// Every payload file in every manifest (before 1.0: in one), and what is listed in its place.
  void check_listing(const std::vector<BagManifest>& payload, const std::vector<BagManifest>& tags) {
    std::map<std::string, std::size_t> listed;
    for (const BagManifest& manifest : payload) {
      for (const BagManifestLine& line : manifest.lines) {
        ++listed[line.path];
        if (!is_payload(line.path)) {
          say(line.path, manifest.name + " lists it, and it is no payload");
        }
      }
    }
    std::set<std::string> tagged;
    for (const BagManifest& manifest : tags) {
      for (const BagManifestLine& line : manifest.lines) {
        tagged.insert(line.path);
        if (is_payload(line.path) || !algorithm_of(line.path, "tagmanifest-").empty()) {
          say(line.path, manifest.name + " lists it, and it is no tag file");
        }
      }
    }
    const std::size_t wanted =
        declaration_.at_least(1, 0) ? payload.size() : std::min<std::size_t>(1, payload.size());
    for (const std::string& name : files_) {
      const auto found = listed.find(name);
      const std::size_t times = found == listed.end() ? 0 : found->second;
      if (is_payload(name) && times == 0 && wanted > 0) {
        say(name, kNoneLists, kMendExtra);
      } else if (is_payload(name) && times < wanted) {
        say(name, kNotAllList);
      }
      if (!is_payload(name) && !tagged.contains(name) && algorithm_of(name, "tagmanifest-").empty()) {
        report_.unrecorded.push_back(name);
      }
    }
    if (files_.contains("fetch.txt")) {
      check_fetch(listed);
    }
  }

  void check_fetch(const std::map<std::string, std::size_t>& listed) {
    const std::optional<std::string> text = text_of("fetch.txt");
    const Result<std::vector<std::string>> fetched =
        text ? parse_bag_fetch(*text, declaration_, "fetch.txt") : std::vector<std::string>();
    if (!fetched) {
      report_.damaged.push_back(fetched.error());
      return;
    }
    for (const std::string& name : *fetched) {
      if (!listed.contains(name)) {
        say(name, "fetch.txt has it and no manifest lists it");
      }
      to_fetch_.insert(name);
    }
  }

  void check_info() {
    if (!files_.contains("bag-info.txt")) {
      return;
    }
    const std::optional<std::string> text = text_of("bag-info.txt");
    if (!text) {
      return;
    }
    // RFC 8493 asks for none; but what was there and is gone is a loss.
    const std::string tags = "tagmanifest-sha512.txt";
    if (is_written_by_dubsar(*text) && !files_.contains(tags) && !is_hidden(tags)) {
      say(tags, "missing: nothing covers bag-info.txt and what else lies beside the payload");
    }
    check_oxum(*text);
  }

  void check_oxum(const std::string& bag_info) {
    const Result<std::optional<BagOxum>> told = parse_bag_oxum(bag_info, "bag-info.txt");
    if (!told) {
      report_.damaged.push_back(told.error());
      return;
    }
    BagOxum there;
    for (const std::string& name : files_) {
      std::error_code ignored;
      if (is_payload(name)) {
        there.bytes += fs::file_size(folder_ / name, ignored);
        ++there.files;
      }
    }
    // What nobody can look at was not counted.
    if (hidden_.empty() && *told && **told != there) {
      say("bag-info.txt", "Payload-Oxum says " + std::to_string((*told)->bytes) + " bytes in " +
                              std::to_string((*told)->files) + " files; there are " +
                              std::to_string(there.bytes) + " in " + std::to_string(there.files));
    }
  }

  Status check_sums(const std::vector<BagManifest>& payload, const std::vector<BagManifest>& tags) {
    std::size_t total = 0;
    for (const auto* group : {&payload, &tags}) {
      for (const BagManifest& manifest : *group) {
        total += manifest.lines.size();
      }
    }
    std::size_t done = 0;
    // The lists of the payload first: whether they are whole says what of the payload is in doubt.
    for (const auto* group : {&tags, &payload}) {
      for (const BagManifest& manifest : *group) {
        for (const BagManifestLine& line : manifest.lines) {
          job_.progress("verify", static_cast<double>(done++) / static_cast<double>(total));
          if (job_.cancelled()) {
            return fail(ErrorKind::kCancelled, "verification cancelled", folder_.string());
          }
          count(line.path, fits_sum(*group, manifest, line));
        }
      }
    }
    for (const auto& [name, whole] : good_) {
      if (whole) {
        report_.whole.push_back(name);
      }
    }
    return {};
  }

  void count(const std::string& name, bool fits) {
    const auto [entry, first] = good_.emplace(name, fits);
    entry->second = entry->second && fits;
  }

  /// Whether the file is whole by this line, or in spite of it.
  bool fits_sum(const std::vector<BagManifest>& group, const BagManifest& manifest,
                const BagManifestLine& line) {
    if (!files_.contains(line.path)) {
      if (is_of_another_name(manifest, line)) {
        return false;
      }
      if (missing_.insert(line.path).second && !is_hidden(line.path)) {
        say(line.path, to_fetch_.contains(line.path) ? "not here: fetch.txt says where it is" : "missing");
      }
      return false;
    }
    const Result<std::string> sum = digest_of_file(manifest.digest, folder_ / line.path, job_);
    if (!sum) {
      say(line.path, sum.error().what);
      return false;
    }
    return *sum == line.sum || is_whole_all_the_same(group, manifest, line, *sum);
  }

  void say_line(const BagManifest& manifest, const BagManifestLine& line, const std::string& what) {
    say(manifest.name, "line " + std::to_string(line.line) + " " + what, kMendLine);
  }

  /// Of a file that is not here: whether it is another one, whose line was damaged. Says so.
  bool is_of_another_name(const BagManifest& manifest, const BagManifestLine& line) {
    const std::optional<std::string> name = file_meant(folder_, files_, manifest, line, job_);
    if (!name) {
      return false;
    }
    say_line(manifest, line,
             "is damaged: it names " + line.path + ", which is not here, with the checksum of " + *name +
                 ", which is whole");
    std::erase(report_.unrecorded, *name);
    std::erase_if(report_.damaged, [&](const Error& error) {
      return error.where == line.path ||
             (error.where == *name && (error.what == kNoneLists || error.what == kNotAllList));
    });
    count(*name, true);
    return true;
  }

  /// Of a file that has another checksum than the line: says which of the two is in doubt.
  bool is_whole_all_the_same(const std::vector<BagManifest>& group, const BagManifest& manifest,
                             const BagManifestLine& line, const std::string& sum) {
    const auto listed = good_.find(manifest.name);
    const bool list_is_whole = listed != good_.end() && listed->second;
    const std::optional<DoubtfulLine> doubt = doubt_of_line(folder_, group, line, sum, list_is_whole, job_);
    if (doubt) {
      say_line(manifest, line, doubt->what);
    } else {
      say(line.path, "not the bytes that " + manifest.name + " says");
    }
    return doubt && doubt->file_is_whole;
  }

  const fs::path& folder_;
  JobContext& job_;
  BagDeclaration declaration_{.major = 1, .minor = 0};
  BagReport report_;
  std::set<std::string> files_;       ///< regular files, relative
  std::set<std::string> to_fetch_;    ///< of fetch.txt
  std::set<std::string> missing_;     ///< told already
  std::map<std::string, bool> good_;  ///< files that were held against a line, and whether they are whole
  std::vector<std::string> hidden_;   ///< folders that cannot be read, each with '/' at its end
};

}  // namespace

bool is_bag(const fs::path& folder) {
  std::error_code ignored;
  // One that has lost its declaration is a bag all the same: that is then its damage.
  return fs::is_regular_file(folder / kDeclaration, ignored) ||
         (fs::is_regular_file(folder / "manifest-sha512.txt", ignored) &&
          fs::is_directory(folder / "data", ignored));
}

bool is_written_by_dubsar(const std::string& bag_info) {
  return ("\n" + bag_info).find("\nBag-Software-Agent: Dubsar ") != std::string::npos;
}

Result<BagReport> check_bag(const fs::path& folder, JobContext& job) {
  Result<BagReport> report = Check(folder, job).run();
  if (report) {
    job.progress("verify", 1.0);
  }
  return report;
}

}  // namespace dubsar
