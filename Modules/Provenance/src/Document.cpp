// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Provenance/Document.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/FileText.h"

#include <openssl/asn1.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <sstream>
#include <unordered_set>

namespace explica::provenance {
namespace {

namespace fs = std::filesystem;

/// Where the first byte stands that is not UTF-8, or is 0; npos if all is well.
std::size_t firstFault(std::string_view text) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(text.data());
  for (std::size_t at = 0; at < text.size();) {
    unsigned long code = 0;
    const auto left = static_cast<int>(std::min<std::size_t>(text.size() - at, 4));
    const int length = UTF8_getc(bytes + at, left, &code);
    if (length < 1 || code == 0 || code > 0x10ffff) return at;
    at += static_cast<std::size_t>(length);
  }
  return std::string_view::npos;
}

int lineAt(std::string_view text, std::size_t place) {
  return 1 + static_cast<int>(
                 std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(place), '\n'));
}

/// A word that YAML leaves untyped, as JSON: null, true, 12, 1.5; all else is text.  A number with
/// a leading zero is a label ("01").  Nothing for a number that no double holds.
std::optional<Json> typedWord(const std::string& word) {
  if (word.empty() || word == "~" || word == "null") return Json(nullptr);
  if (word == "true") return Json(true);
  if (word == "false") return Json(false);
  const std::size_t first = word[0] == '-' || word[0] == '+' ? 1 : 0;
  const auto digit = [&](std::size_t at) {
    return at < word.size() && std::isdigit(static_cast<unsigned char>(word[at]));
  };
  if (!digit(first) && !(first < word.size() && word[first] == '.' && digit(first + 1))) {
    return Json(word);
  }
  if (word[first] == '0' && digit(first + 1)) return Json(word);
  const char* const begin = word.data() + (word[0] == '+' ? 1 : 0);
  const char* const end = word.data() + word.size();
  long long whole = 0;
  auto read = std::from_chars(begin, end, whole);
  if (read.ec == std::errc() && read.ptr == end) return Json(whole);
  double real = 0;
  read = std::from_chars(begin, end, real);
  if (read.ptr != end) return Json(word);
  if (read.ec == std::errc::result_out_of_range) return std::nullopt;
  return Json(real);
}

/// Looks YAML through without keeping it, as far as its limits allow.  The library's own loader of
/// all documents takes a stray ',' for one document after another until no memory is left, and
/// makes nodes of a kilobyte out of a character each.
class YamlSurvey : public YAML::EventHandler {
 public:
  YamlSurvey(const fs::path& path, const DocumentLimits& limits) : path_(path), limits_(limits) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) {
      refuse(mark, "a second document begins here, after --- or a stray comma; one is expected");
    }
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { count(mark); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { count(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                const std::string&) override {
    count(mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    count(mark);
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    count(mark);
  }
  void OnMapEnd() override {}

 private:
  void count(const YAML::Mark& mark) {
    // Keys are no values of their own.
    if (++seen_ > 2 * limits_.values) {
      refuse(mark, "holds more than " + std::to_string(limits_.values) + " values");
    }
  }
  [[noreturn]] void refuse(const YAML::Mark& mark, const std::string& what) const {
    throw InvalidInput(path_.string() + ", line " + std::to_string(mark.line + 1) + ": " + what);
  }

  const fs::path& path_;
  DocumentLimits limits_;
  int documents_ = 0;
  std::size_t seen_ = 0;
};

/// Turns YAML into JSON and keeps the line of each place.
class YamlReader {
 public:
  YamlReader(Document& document, const DocumentLimits& limits)
      : document_(document), limits_(limits) {}

  Json read(const YAML::Node& node, const std::string& place, int depth = 0) {
    const int line = node.Mark().line + 1;
    if (line > 0) document_.lines.try_emplace(place, line);
    if (depth > limits_.depth) {
      refuse(line, "is nested too deeply; an alias (*name) may hold itself");
    }
    if (++count_ > limits_.values) {
      refuse(line, "holds more than " + std::to_string(limits_.values) +
                       " values, where each use of an alias (*name) counts all that it holds");
    }
    if (node.IsSequence()) return readList(node, place, depth);
    if (node.IsMap()) return readMap(node, place, depth);
    if (!node.IsScalar()) return nullptr;
    if (node.Tag() != "?") return node.Scalar();
    const auto typed = typedWord(node.Scalar());
    if (!typed) refuse(line, node.Scalar() + " is larger than any number of this machine");
    return *typed;
  }

 private:
  Json readList(const YAML::Node& node, const std::string& place, int depth) {
    Json array = Json::array();
    for (const YAML::Node& element : node) {
      array.push_back(read(element, place + "/" + std::to_string(array.size()), depth + 1));
    }
    return array;
  }
  Json readMap(const YAML::Node& node, const std::string& place, int depth) {
    Json object = Json::object();
    auto& entries = object.get_ref<Json::object_t&>();
    std::unordered_set<std::string> keys;
    for (const auto& entry : node) {
      const int at = entry.first.Mark().line + 1;
      if (!entry.first.IsScalar()) refuse(at, "has a key that is not a word");
      const std::string& key = entry.first.Scalar();
      const std::string below = place + "/" + key;
      if (!keys.insert(key).second) {
        refuse(at, "'" + key + "' is given twice, first in line " +
                       std::to_string(document_.lines[below]) + "; remove one");
      }
      document_.lines[below] = at;
      // Appended as it is: to look a key up among others takes time in proportion to their number.
      entries.emplace_back(key, read(entry.second, below, depth + 1));
    }
    return object;
  }
  [[noreturn]] void refuse(int line, const std::string& what) const {
    throw InvalidInput(document_.path.string() + ", line " + std::to_string(line) + ": " + what);
  }

  Document& document_;
  DocumentLimits limits_;
  std::size_t count_ = 0;
};

}  // namespace

std::string readText(const fs::path& path, const DocumentLimits& limits) {
  std::string text = fileText(path, limits.bytes);
  if (const std::size_t place = firstFault(text); place != std::string::npos) {
    throw IOError(path.string() + ", line " + std::to_string(lineAt(text, place)) +
                  ": is not text in UTF-8; save it so in your editor");
  }
  return text;
}

Json readJson(const fs::path& path, const DocumentLimits& limits) {
  return parseJson(readText(path, limits), path.string(), limits);
}

Document readDocument(const fs::path& path, const DocumentLimits& limits) {
  Document document;
  document.path = path;
  const std::string text = readText(path, limits);
  if (path.extension() == ".json") {
    document.values = parseJson(text, path.string(), limits, &document.lines);
    return document;
  }
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    YamlSurvey survey(path, limits);
    while (parser.HandleNextDocument(survey)) {
    }
    document.values = YamlReader(document, limits).read(YAML::Load(text), "");
  } catch (const YAML::Exception& fault) {
    throw InvalidInput(path.string() + ", line " + std::to_string(fault.mark.line + 1) +
                       ": is not YAML (" + fault.msg + "); mend the line or the one before");
  }
  return document;
}

}  // namespace explica::provenance
