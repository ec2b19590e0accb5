// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "StrangersRecord.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Provenance/Verify.h"

#include <algorithm>
#include <functional>
#include <optional>

namespace explica::app {
namespace {

using provenance::Json;
namespace fs = std::filesystem;

/// The files that a record says were read, and where they are now.
class RecordedInputs {
 public:
  RecordedInputs(Context& context, const Json& record, const fs::path& recordPath)
      : context_(context),
        record_(record),
        recordPath_(recordPath),
        named_(record["execution"]["inputs"]) {}

  /// Where the input that was given so is now.
  [[nodiscard]] std::optional<std::string> fileNow(const std::string& given) const {
    for (std::size_t i = 0; i < named_.size(); ++i) {
      if (named_[i]["given"] != given) continue;
      const fs::path found = provenance::locateInput(record_, i, recordPath_);
      if (provenance::digestOf(found).sha256 != record_["inputs"][i]["sha256"]) {
        context_.warn(found.string() + " is not the file that was read then");
      }
      return found.string();
    }
    return std::nullopt;
  }

  /// Where the folder is now, if inputs lie below it: such as a FreeSurfer subject.
  [[nodiscard]] std::optional<std::string> folderNow(const std::string& given) const {
    const fs::path directory = record_["execution"].value("directory", "");
    for (const fs::path& candidate : {directory / given, fs::path(given)}) {
      std::error_code fault;
      const fs::path folder = fs::weakly_canonical(candidate, fault);
      if (fault || !isFolder(folder)) continue;
      for (std::size_t i = 0; i < named_.size(); ++i) {
        const fs::path file =
            fs::weakly_canonical(provenance::locateInput(record_, i, recordPath_), fault);
        if (!fault && provenance::staysBelow(file.lexically_relative(folder))) {
          return candidate.string();
        }
      }
    }
    return std::nullopt;
  }

 private:
  Context& context_;
  const Json& record_;
  fs::path recordPath_;
  const Json& named_;
};

/// Applies a function to a text or to each text of a list.
void forEachText(Json& value, const std::function<void(Json&)>& change) {
  if (value.is_string()) change(value);
  if (!value.is_array()) return;
  for (Json& element : value) {
    if (element.is_string()) change(element);
  }
}

/// A default is no choice of the user's: a command may choose better, for its steps above all.
bool wasGiven(const Json& record, const Parameter& parameter, const Json& value) {
  const Json given = record.value("given", Json::array());
  return std::find(given.begin(), given.end(), parameter.option.name) != given.end() ||
         value != provenance::valueOf(parameter.option);
}

bool looksLikeElsewhere(const std::string& text) {
  return !provenance::staysBelow(text) && text.find('/') != std::string::npos;
}

}  // namespace

void requireConfined(const Declaration& declaration, const fs::path& recordPath) {
  if (declaration.writesOutput && !declaration.handsOutputOn) return;
  throw InvalidInput(recordPath.string() + ": explica " + declaration.name +
                     " does not write into a folder of its own, so its record is not replayed; "
                     "give the command line yourself if you trust it");
}

Json confinedValues(Context& context, Declaration& declaration, const Json& record,
                    const fs::path& recordPath, const fs::path& out) {
  const RecordedInputs inputs(context, record, recordPath);
  Json recorded = record["options"];
  recorded.update(record["execution"]["arguments"]);
  Json values = Json::object();
  for (auto& [name, value] : recorded.items()) {
    const auto refuse = [&, name = name](const std::string& text, const std::string& why) {
      throw InvalidInput(recordPath.string() + ": " + name + " is '" + provenance::printable(text) +
                         "', " + why);
    };
    Parameter* parameter = declaration.find(name);
    if (parameter == nullptr) refuse(provenance::textOf(value), "which this version does not know");
    const bool given = wasGiven(record, *parameter, value);
    const bool file = parameter->file.has_value();
    const bool folder =
        file && (*parameter->file == FileKind::Folder || *parameter->file == FileKind::Any);
    forEachText(value, [&](Json& element) {
      const auto text = element.get<std::string>();
      if (parameter->namesOutput) {
        if (!provenance::staysBelow(text)) refuse(text, "which lies outside --out");
        return;
      }
      if (!file && !looksLikeElsewhere(text)) return;
      if (const auto now = inputs.fileNow(text)) {
        element = *now;
      } else if (const auto place = folder || !file ? inputs.folderNow(text) : std::nullopt) {
        element = *place;
      } else {
        refuse(text, "which is none of the inputs that the record names");
      }
    });
    if (parameter->option.place == declaration.reuse) value = false;
    if (given) values[name] = value;
    try {
      provenance::setValue(parameter->option, value);
    } catch (const UsageError& fault) {
      throw InvalidInput(recordPath.string() + ": " + provenance::printable(fault.what()));
    }
  }
  for (const Parameter& parameter : declaration.parameters) {
    if (parameter.option.place == declaration.fallbackOut) {
      values[parameter.option.name] = out.string();
    }
  }
  return values;
}

}  // namespace explica::app
