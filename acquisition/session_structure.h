// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "acquisition/sqlite_db.h"

namespace dubsar::session {

/// Whether what SQLite finds wrong with the structure of a database may have cost rows, all of those that are
/// there being readable. It cannot have where each table's own tree is whole and only an index or the list of
/// free pages is not: a rebuilding from the rows then has all of them.
[[nodiscard]] bool fault_may_cost_rows(SqlDatabase& db);

}  // namespace dubsar::session
