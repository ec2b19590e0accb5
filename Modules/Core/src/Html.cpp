// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Html.h"

#include <map>

namespace explica {

std::string escapeHtml(std::string_view text, std::string_view escaped) {
  static const std::map<char, std::string_view> entities = {
      {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}};
  std::string out;
  for (const char c : text) {
    if (escaped.find(c) == escaped.npos) {
      out += c;
    } else {
      out += entities.at(c);
    }
  }
  return out;
}

std::string scriptSafe(std::string json) {
  for (auto at = json.find('<'); at != json.npos; at = json.find('<', at)) {
    json.replace(at, 1, "\\u003c");
  }
  return json;
}

}  // namespace explica
