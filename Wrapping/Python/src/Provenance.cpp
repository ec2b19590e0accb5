// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Options.h"
#include "Watch.h"

#include "Explica/Provenance/Export.h"
#include "Explica/Provenance/Json.h"
#include "Explica/Provenance/Software.h"
#include "Explica/Provenance/Verify.h"

namespace explica::python {
namespace {

using namespace py::literals;

const char* wordOf(provenance::FileState state) {
  switch (state) {
    case provenance::FileState::Same:
      return "same";
    case provenance::FileState::Changed:
      return "changed";
    case provenance::FileState::Missing:
      return "missing";
    case provenance::FileState::Unhashed:
      return "unhashed";
  }
  return "unknown";
}

}  // namespace

void bindProvenance(py::module_& parent) {
  py::module_ m = parent.def_submodule("provenance");
  m.def(
      "verify",
      [](const std::filesystem::path& record, bool deep) {
        const auto found = unlocked([&] { return provenance::verifyRecord(record, deep); });
        py::list files;
        for (const auto& file : found.files) {
          files.append(py::dict("what"_a = file.what, "path"_a = file.path.string(),
                                "state"_a = wordOf(file.state), "record"_a = file.record.string()));
        }
        return py::dict("all_same"_a = found.allSame(), "records"_a = found.records,
                        "files"_a = files);
      },
      "record"_a, "deep"_a = false,
      "Compare the inputs and outputs that a provenance.json names with what lies on the disk; "
      "with\n"
      "`deep`, also the records that made the inputs.  Returns all_same, records (how many were\n"
      "followed) and files: what, path, record, and state, one of same, changed, missing, "
      "unhashed.");
  m.def(
      "history", [](const std::filesystem::path& file) { return provenance::historyOf(file); },
      "file"_a, "A readable account of how a file came about, newest step first.");
  m.def(
      "read_record",
      [](const std::filesystem::path& path) { return pythonOf(provenance::readRecord(path)); },
      "path"_a, "A provenance.json as a dictionary, checked against its schema.");
  m.def(
      "prov_json",
      [](const std::filesystem::path& path) {
        return pythonOf(provenance::toProvJson({{path, provenance::readRecord(path)}}));
      },
      "path"_a,
      "A provenance.json as W3C PROV-JSON: a dictionary of entities, activity and agent.");
  m.def(
      "sha256",
      [](const std::filesystem::path& file) {
        return unlocked([&] { return provenance::digestOf(file).sha256; });
      },
      "file"_a, "SHA-256 of a file's bytes, 64 hexadecimal digits.");
  m.def(
      "software",
      [] {
        const auto& s = provenance::software();
        return py::dict("version"_a = s.version, "commit"_a = s.commit, "dirty"_a = s.dirty,
                        "build_type"_a = s.buildType, "compiler"_a = s.compiler,
                        "libraries"_a = pythonOf(provenance::describeLibraries()));
      },
      "Version, commit, dirty flag, build_type, compiler and libraries of this build.");
}

}  // namespace explica::python
