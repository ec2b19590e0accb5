// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Study/StudyFile.h"

#include "Explica/Core/Errors.h"

#include <yaml-cpp/yaml.h>

#include <cctype>
#include <charconv>
#include <fstream>
#include <sstream>
#include <unordered_set>

namespace explica::study {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

constexpr int kDeepest = 32;  // levels; an alias that holds itself would never end

std::string readText(const fs::path& path) {
  std::error_code fault;
  if (!fs::is_regular_file(path, fault)) {
    throw IOError(path.string() + ": no such file; a study file in YAML or JSON is needed");
  }
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw IOError(path.string() + ": cannot be read");
  return text.str();
}

/// A word that YAML leaves untyped, as JSON: null, true, 12, 1.5; all else is text.  A number with
/// a leading zero is a label ("01").
Json typedWord(const std::string& word) {
  if (word.empty() || word == "~" || word == "null") return nullptr;
  if (word == "true") return true;
  if (word == "false") return false;
  const std::size_t first = word[0] == '-' || word[0] == '+' ? 1 : 0;
  const auto digit = [&](std::size_t at) {
    return at < word.size() && std::isdigit(static_cast<unsigned char>(word[at]));
  };
  if (!digit(first) && !(first < word.size() && word[first] == '.' && digit(first + 1))) {
    return word;
  }
  if (word[first] == '0' && digit(first + 1)) return word;
  const char* const begin = word.data() + (word[0] == '+' ? 1 : 0);
  const char* const end = word.data() + word.size();
  long long whole = 0;
  auto read = std::from_chars(begin, end, whole);
  if (read.ec == std::errc() && read.ptr == end) return whole;
  double real = 0;
  read = std::from_chars(begin, end, real);
  if (read.ec == std::errc() && read.ptr == end) return real;
  return word;
}

/// Turns YAML into JSON and keeps the line of each place.
class Reader {
 public:
  explicit Reader(StudyFile& file) : file_(file) {}

  Json read(const YAML::Node& node, const std::string& place, int depth = 0) {
    const int line = node.Mark().line + 1;
    if (!file_.lines.count(place) && line > 0) file_.lines[place] = line;
    if (depth > kDeepest) refuse(line, "is nested too deeply; an alias (*name) may hold itself");
    if (node.IsSequence()) {
      Json array = Json::array();
      for (const YAML::Node& element : node) {
        array.push_back(read(element, place + "/" + std::to_string(array.size()), depth + 1));
      }
      return array;
    }
    if (node.IsMap()) {
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
                         std::to_string(file_.lines[below]) + "; remove one");
        }
        file_.lines[below] = at;
        // Appended as it is: to look a key up among others takes time in proportion to their
        // number.
        entries.emplace_back(key, read(entry.second, below, depth + 1));
      }
      return object;
    }
    if (node.IsScalar()) return node.Tag() == "?" ? typedWord(node.Scalar()) : Json(node.Scalar());
    return nullptr;
  }

 private:
  [[noreturn]] void refuse(int line, const std::string& what) const {
    throw InvalidInput(file_.path.string() + ", line " + std::to_string(line) + ": " + what);
  }

  StudyFile& file_;
};

}  // namespace

StudyFile readStudyFile(const fs::path& path) {
  StudyFile file;
  file.path = path;
  const std::string text = readText(path);
  try {
    // JSON is YAML, but for the spaces that YAML wants and tabs that it refuses.
    if (path.extension() == ".json") {
      file.values = provenance::readJson(path);
      Reader(file).read(YAML::Load(text), "");
      return file;
    }
    file.values = Reader(file).read(YAML::Load(text), "");
  } catch (const YAML::Exception& fault) {
    if (path.extension() == ".json") return file;  // without lines
    throw InvalidInput(path.string() + ", line " + std::to_string(fault.mark.line + 1) +
                       ": is not YAML (" + fault.msg + "); mend the line or the one before");
  }
  return file;
}

std::string placeIn(const StudyFile& file, const std::vector<std::string>& place) {
  std::string pointer, dotted;
  int line = 0;
  for (const std::string& part : place) {
    pointer += "/" + part;
    dotted += (dotted.empty() ? "" : ".") + part;
    if (const auto found = file.lines.find(pointer); found != file.lines.end()) {
      line = found->second;
    }
  }
  return file.path.string() + (line > 0 ? ", line " + std::to_string(line) : "") +
         (dotted.empty() ? "" : ", " + dotted) + ": ";
}

}  // namespace explica::study
