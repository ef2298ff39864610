// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/command/outputs.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "formats/resolved_place.h"
#include "station/place_outside.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

/// The same file or folder, whatever it is called (two hard links, too) and whether it exists yet. A device
/// may be written to twice.
bool is_same_place(const std::string& a, const std::string& b) {
  std::error_code error;
  if (fs::exists(a, error) && fs::exists(b, error)) {
    return !fs::is_character_file(a, error) && fs::equivalent(a, b, error);
  }
  return resolved_place(a) == resolved_place(b);
}

/// A name that is mistyped makes no folder.
Status check_folder_of(const std::string& output) {
  const fs::path file = output;
  const fs::path folder = file.parent_path();
  std::error_code error;
  if (!file.has_filename() || folder.empty() || fs::is_directory(folder, error)) {
    return {};
  }
  return fail(ErrorKind::kUsage, "there is no folder " + folder.string(), output,
              "make it first, or look for a slip in the name");
}

/// Two would write to one place at once.
Status check_not_printed_to(const std::string& output) {
  struct stat printed {};
  struct stat written {};
  struct stat nowhere {};
  if (::fstat(STDOUT_FILENO, &printed) != 0 || ::stat(output.c_str(), &written) != 0 ||
      printed.st_dev != written.st_dev || printed.st_ino != written.st_ino ||
      (::stat("/dev/null", &nowhere) == 0 && nowhere.st_rdev == printed.st_rdev &&
       S_ISCHR(printed.st_mode))) {
    return {};
  }
  return fail(ErrorKind::kUsage, "--json prints its object there, and nothing else", output,
              "give the output a file, or leave --json out");
}

}  // namespace

std::string from_folder_of(const std::string& path, const std::string& output) {
  return path.empty() ? path
                      : fs::absolute(path)
                            .lexically_normal()
                            .lexically_relative(fs::absolute(output).lexically_normal().parent_path())
                            .generic_string();
}

std::string as_folder(const std::string& path) {
  return path.empty() ? path : (fs::path(path) / "").string();
}

Status check_apart(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs) {
  for (auto output = outputs.begin(); output != outputs.end(); ++output) {
    const auto is_this = [&](const std::string& other) {
      return !output->empty() && !other.empty() && is_same_place(*output, other);
    };
    if (std::any_of(inputs.begin(), inputs.end(), is_this)) {
      return fail(ErrorKind::kUsage, "what is read would be written over", *output,
                  "give the output a name of its own");
    }
    if (std::any_of(outputs.begin(), output, is_this)) {
      return fail(ErrorKind::kUsage, "two outputs would be written to one place", *output,
                  "give each a name of its own");
    }
  }
  return {};
}

Action with_safe_outputs(std::vector<std::string> outputs, Action action, std::vector<std::string> inputs) {
  return [outputs = std::move(outputs), inputs = std::move(inputs),
          action = std::move(action)](CommandContext& context) -> Result<int> {
    for (const std::string& output : outputs) {
      if (const Status outside = output.empty() ? Status() : check_outside_checked_folders(output);
          !outside) {
        return std::unexpected(outside.error());
      }
    }
    if (const Status apart = check_apart(outputs, inputs); !apart) {
      return std::unexpected(apart.error());
    }
    for (const std::string& output : outputs) {
      if (output.empty()) {
        continue;
      }
      for (const Status& checked :
           {check_folder_of(output), context.json ? check_not_printed_to(output) : Status()}) {
        if (!checked) {
          return std::unexpected(checked.error());
        }
      }
    }
    return action(context);
  };
}

}  // namespace dubsar
