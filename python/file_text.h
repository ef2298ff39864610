// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <pybind11/pybind11.h>

#include <string>

namespace dubsar::python {

/// A file's name, or text that has one in it, as os.fsdecode() gives it: bytes that are no text in the
/// encoding of file names become lone surrogates, and those bytes again. bytes_of() raises
/// UnicodeEncodeError.
pybind11::str text_of(const std::string& bytes);
std::string bytes_of(const pybind11::str& text);

}  // namespace dubsar::python
