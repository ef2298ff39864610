// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <exception>
#include <optional>
#include <string_view>
#include <system_error>

#include "core/result.h"

namespace dubsar {

/// What is to be told where the system started no thread for us, or for TBB: no defect of the program, but a
/// limit of the user, the service or the container, or memory. Nothing of any other exception. Header only,
/// for drivers.
[[nodiscard]] inline std::optional<Error> thread_refusal(const std::exception& thrown) {
  const auto* refused = dynamic_cast<const std::system_error*>(&thrown);
  const bool ours = refused != nullptr && refused->code() == std::errc::resource_unavailable_try_again;
  // TBB has words alone: "pthread_create has failed: Resource temporarily unavailable".
  if (!ours && std::string_view(thrown.what()).find("pthread_create") == std::string_view::npos) {
    return std::nullopt;
  }
  return Error{
      ErrorKind::kInternal,
      "the system starts no more threads: a limit on processes is reached, or memory is short",
      {},
      "end other programs, or raise the limit (ulimit -u; TasksMax of a service, pids of a container)"};
}

}  // namespace dubsar
