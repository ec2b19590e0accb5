// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/SurfaceFile.h"

#include "Explica/Core/Text.h"

#include "ByteSource.h"
#include "FreeSurferFormat.h"
#include "SurfaceFormats.h"

#include <algorithm>

namespace explica::io {
namespace {

bool hasEnding(const SurfaceFormat& format, const std::string& name) {
  return std::ranges::any_of(format.endings,
                             [&name](const char* ending) { return name.ends_with(ending); });
}

/// The format of a file that is read, or nullptr.
const SurfaceFormat* formatOf(const std::filesystem::path& path, ByteView bytes) {
  for (const SurfaceFormat& format : surfaceFormats()) {
    if (format.looksLike(bytes)) return &format;
  }
  std::filesystem::path named = path;
  if (named.extension() == ".gz") named.replace_extension();
  const std::string name = lowerCase(named.filename().string());
  for (const SurfaceFormat& format : surfaceFormats()) {
    if (format.nameTells && hasEnding(format, name)) return &format;
  }
  return nullptr;
}

/// The format that is written under a name.
const SurfaceFormat& formatFor(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  const SurfaceFormat* forAny = nullptr;
  for (const SurfaceFormat& format : surfaceFormats()) {
    if (hasEnding(format, name)) return format;
    if (format.endings.empty()) forAny = &format;
  }
  return *forAny;
}

/// Without the longest of a format's endings that it has.
std::string withoutEnding(const std::string& name) {
  const std::string lower = lowerCase(name);
  std::size_t longest = 0;
  const auto see = [&](const std::string& ending) {
    if (lower.size() > ending.size() && lower.ends_with(ending)) {
      longest = std::max(longest, ending.size());
    }
  };
  for (const SurfaceFormat& format : surfaceFormats()) {
    for (const char* ending : format.endings) see(ending);
    for (const char* ending : format.others) see(ending);
  }
  return name.substr(0, name.size() - longest);
}

std::string allNames() {
  return joined(surfaceFormats(), ", ", [](const SurfaceFormat& format) { return format.name; });
}

}  // namespace

std::string nameOfSurface(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  return withoutEnding(name.ends_with(".gz") ? name.substr(0, name.size() - 3) : name);
}

std::vector<std::string> surfaceEndings() {
  std::vector<std::string> endings;
  for (const SurfaceFormat& format : surfaceFormats()) {
    endings.insert(endings.end(), format.endings.begin(), format.endings.end());
  }
  return endings;
}

LoadedSurface readSurface(const std::filesystem::path& path, const SurfaceReadOptions& options) {
  const Bytes bytes = ByteSource(path).rest();
  if (freeSurferKindOf(bytes) == FreeSurferKind::Curv) {
    refuse(path, "holds per-vertex values; a surface is needed");
  }
  const SurfaceFormat* format = formatOf(path, bytes);
  if (format == nullptr) {
    failToRead(path, "is not a surface of a known format (" + allNames() + ")");
  }
  return format->read(path, bytes, options);
}

void writeSurface(const std::filesystem::path& path, const TriangleMesh& mesh,
                  const SurfaceMetadata& metadata) {
  if (mesh.vertexCount() == 0 || mesh.faceCount() == 0) {
    throw InvalidInput("surface for " + quoted(path) + ": it has no triangles");
  }
  formatFor(path).write(path, mesh, metadata);
}

}  // namespace explica::io
