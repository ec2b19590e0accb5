// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace explica::provenance {

/// JSON whose keys keep their order, so that records read well and equal records are equal bytes.
using Json = nlohmann::ordered_json;

/// How much of a text that others wrote is taken in before it is refused.
struct DocumentLimits {
  std::size_t bytes = std::size_t{64} << 20;  ///< size of the file
  int depth = 64;                             ///< lists and objects within each other
  std::size_t values = 1'000'000;  ///< words, numbers, lists and objects, aliases followed
};

/// A JSON or YAML file as it stands on the disk.
struct Document {
  std::filesystem::path path;
  Json values;                       ///< YAML's plain words typed as in JSON; "01" stays a text
  std::map<std::string, int> lines;  ///< line of a place ("/subjects/01/input"), from 1
};

// The one door for text in JSON and YAML.  All of these refuse, naming file, line and field: a file
// that is none or is larger than the limits allow, bytes that are not UTF-8, faults of syntax, keys
// that are given twice, numbers that no double holds, and what is nested too deeply.

/// The bytes of a text file.
/// @throws IOError  not a regular file, too large, unreadable, or not UTF-8
[[nodiscard]] std::string readText(const std::filesystem::path& path,
                                   const DocumentLimits& limits = {});

/// JSON, in which comments are allowed.
/// @param name  of the file, for messages
/// @param lines  if given, takes the line of each place
/// @throws IOError  names file, line and field
[[nodiscard]] Json parseJson(std::string_view text, const std::string& name,
                             const DocumentLimits& limits = {},
                             std::map<std::string, int>* lines = nullptr);

/// Reads a JSON file.
/// @throws IOError  names file, line and field
[[nodiscard]] Json readJson(const std::filesystem::path& path, const DocumentLimits& limits = {});

/// Reads a YAML file, or a JSON file if its name ends so.
/// @throws IOError       it cannot be read
/// @throws InvalidInput  a fault of syntax, a key that is given twice, several documents, an alias
///                       that expands beyond the limits: file, line and remedy
[[nodiscard]] Document readDocument(const std::filesystem::path& path,
                                    const DocumentLimits& limits = {});

/// The JSON text of a value; bytes that are not UTF-8, as file names may hold, become U+FFFD.
[[nodiscard]] std::string textOf(const Json& value, int indent = -1);

}  // namespace explica::provenance
