// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Xml.h"

#include "Explica/Core/Html.h"

#include <expat.h>

#include <algorithm>
#include <memory>
#include <type_traits>

namespace explica::io {
namespace {

constexpr std::size_t kDeepest = 64;  // elements in one another; our formats have six
// Elements and attributes take some hundred bytes each: a table of 16,000 labels, and beyond it as
// many as stand between real data.
constexpr std::size_t kMostNodes = 100'000, kBytesEach = 100;
constexpr int kStep = 1 << 20;  // expat counts in int

struct Builder {
  XML_Parser parser;
  XmlElement document;  ///< its only child is the root
  std::vector<XmlElement*> open{&document};
  std::size_t most;       ///< elements and attributes
  std::size_t nodes = 0;  ///< of them, so far
};

void onStart(void* data, const XML_Char* name, const XML_Char** attributes) {
  auto& builder = *static_cast<Builder*>(data);
  ++builder.nodes;
  for (const XML_Char** at = attributes; *at != nullptr; at += 2) ++builder.nodes;
  if (builder.open.size() > kDeepest || builder.nodes > builder.most) {
    XML_StopParser(builder.parser, XML_FALSE);
    return;
  }
  XmlElement& parent = *builder.open.back();
  parent.children.emplace_back();  // only the last child of each open element is open: none moves
  XmlElement& element = parent.children.back();
  element.name = name;
  for (; *attributes != nullptr; attributes += 2) element.attributes[attributes[0]] = attributes[1];
  builder.open.push_back(&element);
}

void onEnd(void* data, const XML_Char*) {
  static_cast<Builder*>(data)->open.pop_back();
}

void onText(void* data, const XML_Char* text, int length) {
  static_cast<Builder*>(data)->open.back()->text.append(text, static_cast<std::size_t>(length));
}

/// A tag is kept whole until it ends, with all its attributes.
void requireShortTags(const std::filesystem::path& path, std::string_view document) {
  constexpr std::size_t kLongest = 1 << 18;  // bytes
  for (std::size_t at = document.find('<'); at != std::string_view::npos;
       at = document.find('<', at + 1)) {
    const std::string_view tag = document.substr(at, kLongest);
    const bool text = tag.starts_with("<![CDATA[") || tag.starts_with("<!--");
    if (!text && tag.size() == kLongest && tag.find('>') == std::string_view::npos) {
      failToRead(path, "has an XML tag of more than 256 kB");
    }
  }
}

}  // namespace

std::string XmlElement::operator[](const std::string& key) const {
  const auto found = attributes.find(key);
  return found == attributes.end() ? std::string() : found->second;
}

const XmlElement* XmlElement::child(std::string_view childName) const {
  for (const XmlElement& candidate : children) {
    if (candidate.name == childName) return &candidate;
  }
  return nullptr;
}

XmlElement parseXml(const std::filesystem::path& path, std::string_view document) {
  requireShortTags(path, document);
  const std::unique_ptr<std::remove_pointer_t<XML_Parser>, decltype(&XML_ParserFree)> parser(
      XML_ParserCreate(nullptr), &XML_ParserFree);
  Builder builder{parser.get(), {}, {}, std::max(kMostNodes, document.size() / kBytesEach)};
  builder.open = {&builder.document};
  XML_SetUserData(parser.get(), &builder);
  XML_SetElementHandler(parser.get(), onStart, onEnd);
  XML_SetCharacterDataHandler(parser.get(), onText);
  for (std::size_t at = 0;; at += kStep) {
    const std::string_view piece = document.substr(at, kStep);
    const bool last = at + kStep >= document.size();
    if (XML_Parse(parser.get(), piece.data(), static_cast<int>(piece.size()), last) !=
        XML_STATUS_OK) {
      if (builder.nodes > builder.most) {
        failToRead(path, "holds more than " + std::to_string(builder.most) +
                             " XML elements and attributes, far more than such a file has");
      }
      failToRead(path, "is damaged or truncated: XML line " +
                           std::to_string(XML_GetCurrentLineNumber(parser.get())) + ": " +
                           XML_ErrorString(XML_GetErrorCode(parser.get())));
    }
    if (last) break;
  }
  if (builder.document.children.empty()) failToRead(path, "holds no XML");
  return std::move(builder.document.children.front());
}

std::string escapedXml(std::string_view text) {
  return escapeHtml(text, "&<>\"");
}

std::string trimmedText(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(kBlanks) - first + 1));
}

}  // namespace explica::io
