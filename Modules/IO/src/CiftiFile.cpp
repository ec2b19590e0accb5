// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/CiftiFile.h"

#include "Bytes.h"
#include "GiftiFormat.h"
#include "Xml.h"

#include "Explica/Core/WholeFile.h"

#include <cmath>
#include <map>
#include <set>

namespace explica::io {
namespace {

// CIFTI-2 is NIfTI-2 with an XML extension; dimension 5 counts the maps, 6 the vertices.
constexpr std::size_t kNifti2Header = 540;
constexpr std::int32_t kExtensionCode = 32;

enum class Kind { Scalars, Series, Labels };

struct KindRow {
  const char* ending;
  std::int32_t intent;
  const char* intentName;
  const char* mapType;
};

const KindRow& rowOf(Kind kind) {
  static constexpr KindRow kRows[] = {
      {".dscalar.nii", 3006, "ConnDenseScalar", "CIFTI_INDEX_TYPE_SCALARS"},
      {".dtseries.nii", 3002, "ConnDenseSeries", "CIFTI_INDEX_TYPE_SERIES"},
      {".dlabel.nii", 3007, "ConnDenseLabel", "CIFTI_INDEX_TYPE_LABELS"}};
  return kRows[static_cast<int>(kind)];
}

std::string brainStructure(const std::string& structure) {
  if (structure == "CortexLeft") return "CIFTI_STRUCTURE_CORTEX_LEFT";
  if (structure == "CortexRight") return "CIFTI_STRUCTURE_CORTEX_RIGHT";
  throw InvalidInput("CIFTI: structure '" + structure +
                     "' is neither CortexLeft nor CortexRight; hemispheres are needed");
}

std::string brainModels(const std::vector<const CiftiStructure*>& structures) {
  std::string text =
      "<MatrixIndicesMap AppliesToMatrixDimension=\"1\" "
      "IndicesMapToDataType=\"CIFTI_INDEX_TYPE_BRAIN_MODELS\">\n";
  std::size_t offset = 0;
  for (const CiftiStructure* s : structures) {
    text += "<BrainModel IndexOffset=\"" + std::to_string(offset) + "\" IndexCount=\"" +
            std::to_string(s->vertices.size()) +
            "\" ModelType=\"CIFTI_MODEL_TYPE_SURFACE\" BrainStructure=\"" +
            brainStructure(s->structure) + "\" SurfaceNumberOfVertices=\"" +
            std::to_string(s->vertexCount) + "\">\n<VertexIndices>";
    for (std::size_t n = 0; n < s->vertices.size(); ++n) {
      if (n > 0) text += ' ';
      text += std::to_string(s->vertices[n]);
    }
    text += "</VertexIndices>\n</BrainModel>\n";
    offset += s->vertices.size();
  }
  return text + "</MatrixIndicesMap>\n";
}

std::string document(const std::string& maps, const std::string& models) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<CIFTI Version=\"2\">\n<Matrix>\n" + maps +
         models + "</Matrix>\n</CIFTI>\n";
}

std::string openMap(Kind kind, const std::string& more = {}) {
  return std::string("<MatrixIndicesMap AppliesToMatrixDimension=\"0\" IndicesMapToDataType=\"") +
         rowOf(kind).mapType + "\"" + more + ">\n";
}

std::string namedMap(const std::string& name, const std::string& table = {}) {
  return "<NamedMap>\n<MapName>" + escapedXml(name) + "</MapName>\n" + table + "</NamedMap>\n";
}

void check(const std::vector<const CiftiStructure*>& structures) {
  std::set<std::string> seen;
  std::size_t vertices = 0;
  for (const CiftiStructure* s : structures) {
    if (!seen.insert(brainStructure(s->structure)).second) {
      throw InvalidInput("CIFTI: " + s->structure + " is there twice");
    }
    vertices += s->vertices.size();
    for (std::size_t n = 0; n < s->vertices.size(); ++n) {
      const bool ascends = n == 0 || s->vertices[n] > s->vertices[n - 1];
      if (!ascends || s->vertices[n] < 0 || s->vertices[n] >= s->vertexCount) {
        throw InvalidInput("CIFTI: vertices of " + s->structure +
                           " must ascend and be on the surface");
      }
    }
  }
  if (vertices == 0) throw InvalidInput("CIFTI: no vertex is in it");
}

/// @param values  vertices x maps, the maps of a vertex together
CiftiFile fileOf(Kind kind, std::size_t maps, std::string xml, std::vector<float> values,
                 double step) {
  Bytes head(kNifti2Header + 4);
  const auto put = [&head](std::size_t at, auto value) { store(head.data() + at, value, false); };
  put(0, static_cast<std::int32_t>(kNifti2Header));
  std::memcpy(head.data() + 4, "n+2\0\r\n\032\n", 8);
  constexpr std::int16_t kFloat32 = 16;  // NIfTI's code of the type
  put(12, kFloat32);
  put(14, std::int16_t{32});
  const std::int64_t dim[8] = {6,
                               1,
                               1,
                               1,
                               1,
                               static_cast<std::int64_t>(maps),
                               static_cast<std::int64_t>(values.size() / maps),
                               1};
  for (std::size_t i = 0; i < 8; ++i) {
    put(16 + 8 * i, dim[i]);
    put(104 + 8 * i, i == 5 ? step : 1.0);
  }
  put(176, 1.0);                                          // slope
  constexpr std::int32_t kMillimetresAndSeconds = 2 + 8;  // NIfTI's code of the units
  put(500, kMillimetresAndSeconds);
  put(504, rowOf(kind).intent);
  std::memcpy(head.data() + 508, rowOf(kind).intentName, std::strlen(rowOf(kind).intentName));
  head[kNifti2Header] = 1;  // an extension follows: its size, a multiple of 16, its code, the text
  xml.append((16 - (xml.size() + 8) % 16) % 16, '\0');
  append(head, static_cast<std::int32_t>(xml.size() + 8), false);
  append(head, kExtensionCode, false);
  head.insert(head.end(), xml.begin(), xml.end());
  put(168, static_cast<std::int64_t>(head.size()));
  return {rowOf(kind).ending, std::move(head), std::move(values)};
}

std::vector<const CiftiStructure*> structuresOf(const std::vector<CiftiPart>& parts) {
  std::vector<const CiftiStructure*> structures;
  for (const CiftiPart& part : parts) structures.push_back(&part.where);
  return structures;
}

CiftiFile mapsFile(Kind kind, const std::vector<CiftiPart>& parts, const std::string& maps,
                   double step) {
  const auto structures = structuresOf(parts);
  check(structures);
  const std::size_t count = parts.front().maps.size();
  std::vector<float> values;
  for (const CiftiPart& part : parts) {
    if (part.maps.size() != count || count == 0) {
      throw InvalidInput("CIFTI: its hemispheres have " + std::to_string(count) + " and " +
                         std::to_string(part.maps.size()) + " maps; the same ones are needed");
    }
    for (const VertexMap& map : part.maps) {
      if (map.values.size() != part.where.vertexCount) {
        throw InvalidInput("CIFTI: '" + map.name + "' has " + std::to_string(map.values.size()) +
                           " values for " + std::to_string(part.where.vertexCount) + " vertices");
      }
    }
    for (const std::int32_t v : part.where.vertices) {
      for (const VertexMap& map : part.maps) values.push_back(static_cast<float>(map.values[v]));
    }
  }
  return fileOf(kind, count, document(maps, brainModels(structures)), std::move(values), step);
}

void requireParts(bool empty) {
  if (empty) throw InvalidInput("CIFTI: there is no hemisphere");
}

}  // namespace

CiftiStructure ciftiStructure(const std::string& structure, const Eigen::VectorXd& in) {
  CiftiStructure where{structure, in.size(), {}};
  for (Eigen::Index v = 0; v < in.size(); ++v) {
    if (std::isfinite(in[v]) && in[v] != 0) where.vertices.push_back(static_cast<std::int32_t>(v));
  }
  return where;
}

CiftiFile ciftiScalars(const std::vector<CiftiPart>& parts) {
  requireParts(parts.empty());
  std::string maps = openMap(Kind::Scalars);
  for (const VertexMap& map : parts.front().maps) maps += namedMap(map.name);
  return mapsFile(Kind::Scalars, parts, maps + "</MatrixIndicesMap>\n", 1);
}

CiftiFile ciftiSeries(const std::vector<CiftiPart>& parts, double secondsApart) {
  requireParts(parts.empty());
  if (!(secondsApart > 0)) throw InvalidInput("seconds between frames: must be positive");
  std::string step;
  appendNumber(step, secondsApart);
  const std::string maps =
      openMap(Kind::Series, " NumberOfSeriesPoints=\"" + std::to_string(parts.front().maps.size()) +
                                "\" SeriesExponent=\"0\" SeriesStart=\"0\" SeriesStep=\"" + step +
                                "\" SeriesUnit=\"SECOND\"") +
      "</MatrixIndicesMap>\n";
  return mapsFile(Kind::Series, parts, maps, secondsApart);
}

CiftiFile ciftiLabels(const std::vector<CiftiLabels>& parts) {
  requireParts(parts.empty());
  std::vector<const CiftiStructure*> structures;
  std::map<Label, LabelEntry> table;
  std::vector<float> values;
  for (const CiftiLabels& part : parts) {
    structures.push_back(&part.where);
    for (const LabelEntry& entry : part.labels.table) {
      const auto [found, added] = table.emplace(entry.key, entry);
      if (!added && found->second.name != entry.name) {
        throw InvalidInput("CIFTI: key " + std::to_string(entry.key) + " is '" +
                           found->second.name + "' in one hemisphere and '" + entry.name +
                           "' in the other; give them keys of their own");
      }
    }
    if (part.labels.keys.size() != part.where.vertexCount) {
      throw InvalidInput("CIFTI: there is not one label a vertex");
    }
    for (const std::int32_t v : part.where.vertices) {
      const Label key = part.labels.keys[v];
      if (!table.contains(key)) {
        throw InvalidInput("CIFTI: key " + std::to_string(key) + " at vertex " + std::to_string(v) +
                           " is not in the table of names");
      }
      values.push_back(static_cast<float>(key));
    }
  }
  check(structures);
  table.emplace(0, LabelEntry{0, "???", {1, 1, 1, 0}});  // which every CIFTI table has
  std::vector<LabelEntry> entries;
  entries.reserve(table.size());
  for (const auto& [key, entry] : table) entries.push_back(entry);
  const std::string maps = openMap(Kind::Labels) +
                           namedMap(parts.front().labels.name, labelTableXml(entries)) +
                           "</MatrixIndicesMap>\n";
  return fileOf(Kind::Labels, 1, document(maps, brainModels(structures)), std::move(values), 1);
}

void CiftiFile::write(const std::filesystem::path& path) const {
  if (!path.filename().string().ends_with(ending)) {
    throw InvalidInput("CIFTI file " + quoted(path) + ": its name must end in " + ending);
  }
  WholeFile file(path);
  file.write(head.data(), head.size());
  file.write(values.data(), values.size() * sizeof(float));
  file.commit();
}

}  // namespace explica::io
