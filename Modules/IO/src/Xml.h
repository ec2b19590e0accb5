// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Bytes.h"

#include <map>
#include <string>
#include <vector>

namespace explica::io {

/// An element of an XML document with all below it.
struct XmlElement {
  std::string name;
  std::map<std::string, std::string> attributes;
  std::string text;
  std::vector<XmlElement> children;

  /// Attribute, or empty text.
  [[nodiscard]] std::string operator[](const std::string& key) const;
  /// First child of that name, or null.
  [[nodiscard]] const XmlElement* child(std::string_view childName) const;
};

/// Root of a document.
/// @throws IOError  not well-formed
[[nodiscard]] XmlElement parseXml(const std::filesystem::path& path, std::string_view document);

/// Text with the characters replaced that mean something to XML.
[[nodiscard]] std::string escapedXml(std::string_view text);

/// Text without blanks at both ends.
[[nodiscard]] std::string trimmedText(std::string_view text);

}  // namespace explica::io
