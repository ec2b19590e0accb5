// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/SpecFile.h"

#include "Bytes.h"
#include "Xml.h"

#include "Explica/Core/WholeFile.h"

#include <utility>

namespace explica::io {
namespace {

const char* kindOf(const std::filesystem::path& file) {
  static constexpr std::pair<const char*, const char*> kKinds[] = {
      {".surf.gii", "SURFACE"}, {".shape.gii", "METRIC"}, {".func.gii", "METRIC"},
      {".label.gii", "LABEL"},  {".nii", "VOLUME"},       {".nii.gz", "VOLUME"}};
  for (const auto& [ending, kind] : kKinds) {
    if (file.string().ends_with(ending)) return kind;
  }
  throw InvalidInput("spec entry " + quoted(file) +
                     ": Workbench knows .surf.gii, .shape.gii, .func.gii, .label.gii, .nii.gz");
}

}  // namespace

void writeSpec(const std::filesystem::path& path, const std::vector<SpecEntry>& entries) {
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<CaretSpecFile Version=\"1.0\">\n<MetaData/>\n";
  for (const SpecEntry& entry : entries) {
    const std::filesystem::path relative =
        entry.file.is_absolute()
            ? entry.file.lexically_relative(std::filesystem::absolute(path).parent_path())
            : entry.file;
    const std::string kind = kindOf(entry.file);
    text += "<DataFile Structure=\"" +
            (kind == "VOLUME" ? std::string("Invalid") : entry.structure) + "\" DataFileType=\"" +
            kind + "\" Selected=\"true\">" + escapedXml(relative.generic_string()) +
            "</DataFile>\n";
  }
  writeTextFile(path, text + "</CaretSpecFile>\n");
}

}  // namespace explica::io
