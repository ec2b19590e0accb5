// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Provenance/Options.h"

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

namespace explica::python {

namespace py = pybind11;

/// Sets options from keyword arguments; Python's max_iterations is the command line's
/// --max-iterations.
/// @throws TypeError  unknown keyword: lists the known ones
void setFromKeywords(std::vector<provenance::Option> options, const py::kwargs& keywords,
                     const std::vector<std::string>& alsoAllowed = {});

/// An options struct with its defaults and the keywords given.
template <class Options>
[[nodiscard]] Options optionsOf(const py::kwargs& keywords,
                                const std::vector<std::string>& alsoAllowed = {}) {
  Options options;
  setFromKeywords(provenance::listOptions(options), keywords, alsoAllowed);
  return options;
}

/// "Keywords" paragraph of a docstring: name, type, default, unit and meaning of each option.
[[nodiscard]] std::string keywordHelp(const std::vector<provenance::Option>& options);

template <class Options>
[[nodiscard]] std::string keywordHelp() {
  Options options;
  return keywordHelp(provenance::listOptions(options));
}

/// Names, types and defaults of the options, as a dictionary.
[[nodiscard]] py::dict defaultsOf(const std::vector<provenance::Option>& options);

template <class Options>
[[nodiscard]] py::dict defaultsOf() {
  Options options;
  return defaultsOf(provenance::listOptions(options));
}

}  // namespace explica::python
