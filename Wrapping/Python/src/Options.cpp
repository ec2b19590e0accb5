// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Options.h"

#include "Explica/Core/Text.h"

#include <pybind11/stl.h>

#include <algorithm>

namespace explica::python {
namespace {

std::string pythonName(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  std::replace(name.begin(), name.end(), '.', '_');
  return name == "lambda" ? "lambda_" : name;  // the one option that is a word of Python's own
}

provenance::Json jsonOf(const py::handle& value) {
  if (value.is_none()) return nullptr;
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>();
  if (py::isinstance<py::int_>(value)) return value.cast<long long>();
  if (py::isinstance<py::float_>(value)) return value.cast<double>();
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  if (py::hasattr(value, "item") && py::hasattr(value, "ndim") &&
      value.attr("ndim").cast<int>() == 0) {
    return jsonOf(value.attr("item")());  // a numpy scalar
  }
  if (py::hasattr(value, "__fspath__")) return py::str(value).cast<std::string>();
  if (py::isinstance<py::iterable>(value)) {
    provenance::Json list = provenance::Json::array();
    for (const py::handle item : value) list.push_back(jsonOf(item));
    return list;
  }
  throw py::type_error("cannot use a value of type " +
                       py::str(py::type::handle_of(value)).cast<std::string>() + " as an option");
}

}  // namespace

py::object pythonOf(const provenance::Json& value) {
  if (value.is_null()) return py::none();
  if (value.is_boolean()) return py::bool_(value.get<bool>());
  if (value.is_number_integer()) return py::int_(value.get<long long>());
  if (value.is_number()) return py::float_(value.get<double>());
  if (value.is_string()) return py::str(value.get<std::string>());
  if (value.is_object()) {
    py::dict dict;
    for (const auto& [key, item] : value.items()) dict[py::str(key)] = pythonOf(item);
    return dict;
  }
  py::list list;
  for (const auto& item : value) list.append(pythonOf(item));
  return list;
}

void setFromKeywords(std::vector<provenance::Option> options, const py::kwargs& keywords) {
  for (const auto& [key, value] : keywords) {
    const auto name = key.cast<std::string>();
    const auto option = std::find_if(options.begin(), options.end(), [&](const auto& candidate) {
      return pythonName(candidate.name) == name;
    });
    if (option == options.end()) {
      throw py::type_error("unexpected keyword '" + name +
                           "'; known: " + joined(options, ", ", [](const auto& one) {
                             return pythonName(one.name);
                           }));
    }
    provenance::setValue(*option, jsonOf(value));
  }
}

std::string keywordHelp(const std::vector<provenance::Option>& options) {
  std::string text = "\n\nKeywords\n--------\n";
  for (const auto& option : options) {
    text += pythonName(option.name) + " : " + option.type + (option.isList ? " list" : "");
    const std::string value = option.text();
    if (!value.empty()) text += " = " + value;
    if (!option.unit.empty()) text += " [" + option.unit + "]";
    text += "\n    " + option.help;
    if (const auto choices = option.choices; !choices.empty()) {
      text += " (";
      for (std::size_t i = 0; i < choices.size(); ++i) text += (i ? ", " : "") + choices[i];
      text += ")";
    }
    text += "\n";
  }
  return text;
}

void noteKeywords(py::module_& m, const std::string& function,
                  const std::vector<provenance::Option>& options) {
  using namespace py::literals;
  if (!py::hasattr(m, "keywords")) m.attr("keywords") = py::dict();
  py::list list;
  for (const auto& option : options) {
    list.append(py::dict("name"_a = pythonName(option.name), "type"_a = option.type,
                         "choices"_a = option.choices, "optional"_a = option.isOptional,
                         "list"_a = option.isList,
                         "default"_a = pythonOf(provenance::valueOf(option))));
  }
  m.attr("keywords")[py::str(function)] = list;
}

}  // namespace explica::python
