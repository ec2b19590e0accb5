// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/StatedHemisphere.h"

#include "Explica/IO/SurfaceFile.h"

#include "ByteSource.h"
#include "GiftiFormat.h"

namespace explica::io {
namespace {

constexpr std::size_t kHead = 4096;  // bytes in which a format shows itself

/// The value of the first AnatomicalStructurePrimary.  Arrays are not unpacked: the text is
/// searched, in which names and values may stand in CDATA sections.
std::string_view giftiStructure(std::string_view text) {
  constexpr std::string_view kKey = "AnatomicalStructurePrimary", kValue = "<Value>";
  const std::size_t key = text.find(kKey);
  if (key == std::string_view::npos) return {};
  text = text.substr(key + kKey.size(), text.find("</MD>", key) - key - kKey.size());
  const std::size_t value = text.find(kValue);
  return value == std::string_view::npos ? std::string_view() : text.substr(value);
}

std::optional<Hemisphere> hemisphereOf(std::string_view structure) {
  if (structure.find("CortexLeft") != std::string_view::npos) return Hemisphere::Left;
  if (structure.find("CortexRight") != std::string_view::npos) return Hemisphere::Right;
  return {};
}

}  // namespace

std::optional<Hemisphere> statedHemisphere(const std::filesystem::path& file) {
  try {
    ByteSource source(file);
    if (looksLikeGifti(source.peek(kHead))) {
      const Bytes bytes = source.rest();
      if (const auto stated = hemisphereOf(giftiStructure(textOf(bytes)))) return stated;
    }
  } catch (const Error&) {
    // Its reader says what is wrong with it.
  }
  return hemisphereOf(structureFromName(file));
}

std::string statedStructure(const std::filesystem::path& file) {
  const std::optional<Hemisphere> stated = statedHemisphere(file);
  if (!stated) return {};
  return *stated == Hemisphere::Left ? "CortexLeft" : "CortexRight";
}

std::string withoutSide(std::string name) {
  for (const std::string_view ending : {"_L", "_R", "_left", "_right"}) {
    if (name.ends_with(ending)) name.resize(name.size() - ending.size());
  }
  for (const std::string_view beginning : {"ctx-lh-", "ctx-rh-", "lh_", "rh_", "lh.", "rh."}) {
    if (name.starts_with(beginning)) name.erase(0, beginning.size());
  }
  return name;
}

}  // namespace explica::io
