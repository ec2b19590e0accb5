// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/Provenance/Document.h"

#include <sstream>
#include <unordered_set>
#include <vector>

namespace explica::provenance {
namespace {

/// Builds a value from the parser's events, within limits, and knows the place of each.
class Builder : public nlohmann::json_sax<Json> {
 public:
  /// @param source  from which the parser takes the text: it does not tell where a value stands
  Builder(std::string_view text, std::streambuf& source, std::string name,
          const DocumentLimits& limits, std::map<std::string, int>* lines)
      : text_(text), source_(source), name_(std::move(name)), limits_(limits), lines_(lines) {}

  Json root;

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  bool number_unsigned(number_unsigned_t value) override { return add(value); }
  bool number_float(number_float_t value, const string_t&) override { return add(value); }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t&) override { return add(nullptr); }
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    Level& level = levels_.back();
    level.key = name;
    if (!level.keys.insert(name).second) refuse("is given twice; remove one");
    return true;
  }

  bool parse_error(std::size_t, const std::string& token,
                   const nlohmann::detail::exception& fault) override {
    if (dynamic_cast<const Json::out_of_range*>(&fault) != nullptr) {
      refuse(token + " is larger than any number of this machine");
    }
    // "[json.exception...] parse error at line 1, column 2: syntax error while ..."
    const std::string said = fault.what();
    const auto colon = said.find(": ");
    refuse("is not JSON: " + (colon == std::string::npos ? said : said.substr(colon + 2)));
  }

 private:
  struct Level {
    Json* value;
    std::string key;
    std::unordered_set<std::string> keys;
  };

  /// Puts a value where the parser is.
  Json* place(Json value) {
    if (++count_ > limits_.values) {
      refuse("holds more than " + std::to_string(limits_.values) + " values");
    }
    if (levels_.empty()) {
      root = std::move(value);
      return &root;
    }
    Level& level = levels_.back();
    if (lines_ != nullptr) (*lines_)[pointer()] = line();
    if (level.value->is_array()) {
      level.value->push_back(std::move(value));
      return &level.value->back();
    }
    // Appended as it is: to look a key up among others takes time in proportion to their number.
    auto& entries = level.value->get_ref<Json::object_t&>();
    entries.emplace_back(level.key, std::move(value));
    return &entries.back().second;
  }
  bool add(Json value) {
    place(std::move(value));
    return true;
  }
  bool open(Json value) {
    if (static_cast<int>(levels_.size()) >= limits_.depth) {
      refuse("is nested more than " + std::to_string(limits_.depth) + " levels deep");
    }
    levels_.push_back({place(std::move(value)), "", {}});
    return true;
  }
  bool close() {
    levels_.pop_back();
    return true;
  }

  /// The key or index of what is being read at a level.  In the innermost list it is not yet there.
  [[nodiscard]] std::string keyOf(const Level& level) const {
    if (!level.value->is_array()) return level.key;
    return std::to_string(level.value->size() - (&level == &levels_.back() ? 0 : 1));
  }
  [[nodiscard]] std::string pointer() const {
    std::string all;
    for (const Level& level : levels_) all += "/" + keyOf(level);
    return all;
  }
  /// The line of what was read last.  The last character may be the one after it.
  [[nodiscard]] int line() const {
    const auto taken = source_.pubseekoff(0, std::ios::cur, std::ios::in);
    for (; counted_ + 1 < taken; ++counted_) line_ += text_[counted_] == '\n';
    return line_;
  }
  [[noreturn]] void refuse(const std::string& what) const {
    const std::string field =
        joined(levels_, ".", [this](const Level& level) { return keyOf(level); });
    throw IOError(name_ + ", line " + std::to_string(line()) + (field.empty() ? "" : ", " + field) +
                  ": " + what);
  }

  std::string_view text_;
  std::streambuf& source_;
  std::string name_;
  DocumentLimits limits_;
  std::map<std::string, int>* lines_;
  std::vector<Level> levels_;
  std::size_t count_ = 0;
  mutable std::streamoff counted_ = 0;  ///< characters whose line ends are in line_
  mutable int line_ = 1;
};

}  // namespace

Json parseJson(std::string_view text, const std::string& name, const DocumentLimits& limits,
               std::map<std::string, int>* lines) {
  std::istringstream stream{std::string(text)};
  Builder builder(text, *stream.rdbuf(), name, limits, lines);
  if (!Json::sax_parse(stream, &builder, Json::input_format_t::json, true, true)) {
    throw IOError(name + ": is not JSON");
  }
  return std::move(builder.root);
}

std::string textOf(const Json& value, int indent) {
  return value.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace explica::provenance
