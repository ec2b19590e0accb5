// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Provenance/Json.h"

#include <pybind11/pybind11.h>

#include <string>
#include <utility>
#include <vector>

namespace explica::python {

namespace py = pybind11;

/// A JSON value as Python's own: None, bool, int, float, str, list or dict.
[[nodiscard]] py::object pythonOf(const provenance::Json& value);

/// Sets options from keyword arguments; Python's max_iterations is the command line's
/// --max-iterations.
/// @throws TypeError  unknown keyword: lists the known ones
void setFromKeywords(std::vector<provenance::Option> options, const py::kwargs& keywords);

/// An options struct with its defaults and the keywords given.
template <class Options>
[[nodiscard]] Options optionsOf(const py::kwargs& keywords) {
  Options options;
  setFromKeywords(provenance::listOptions(options), keywords);
  return options;
}

/// "Keywords" paragraph of a docstring: name, type, default, unit and meaning of each option.
[[nodiscard]] std::string keywordHelp(const std::vector<provenance::Option>& options);

template <class Options>
[[nodiscard]] std::string keywordHelp() {
  Options options;
  return keywordHelp(provenance::listOptions(options));
}

/// Notes the keywords that a function takes in `m.keywords`, a dictionary from the function's name
/// to a list of {name, type, choices, optional, list, default}: what signatures and stubs are made
/// of.
void noteKeywords(py::module_& m, const std::string& function,
                  const std::vector<provenance::Option>& options);

template <class Options>
void noteKeywords(py::module_& m, const std::string& function) {
  Options options;
  noteKeywords(m, function, provenance::listOptions(options));
}

/// Defines a function that takes the options of a struct as keywords: they follow in its docstring.
template <class Options, class Function, class... Extra>
void defWithOptions(py::module_& m, const char* name, Function&& function, const std::string& doc,
                    const Extra&... extra) {
  m.def(name, std::forward<Function>(function), extra..., (doc + keywordHelp<Options>()).c_str());
  noteKeywords<Options>(m, name);
}

}  // namespace explica::python
