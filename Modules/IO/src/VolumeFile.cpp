// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/VolumeFile.h"

#include "ByteSource.h"
#include "PackedFile.h"
#include "StoredVolume.h"
#include "VolumeFormats.h"

#include "Explica/Core/Folders.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/Text.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <sstream>
#include <type_traits>

namespace explica::io {
namespace {

constexpr std::size_t kGrain = 1 << 18;  // voxels a task
constexpr std::size_t kPiece =
    1 << 14;  // voxels that are converted at once: they stay in the caches

std::string sizeText(const std::vector<int>& size) {
  return joined(size, " x ", [](int n) { return std::to_string(n); });
}

std::string voxelText(const Grid& grid, std::size_t voxel) {
  const std::array<int, 3> at = grid.subscripts(voxel);
  return "(" + std::to_string(at[0]) + ", " + std::to_string(at[1]) + ", " + std::to_string(at[2]) +
         ")";
}

/// What a pass over the voxels found.
struct Survey {
  std::size_t nonZero = 0;
  std::size_t bad = 0;
  std::size_t firstBad = std::numeric_limits<std::size_t>::max();

  Survey& operator+=(const Survey& other) {
    nonZero += other.nonZero;
    bad += other.bad;
    firstBad = std::min(firstBad, other.firstBad);
    return *this;
  }
  void addBad(std::size_t voxel) {
    ++bad;
    firstBad = std::min(firstBad, voxel);
  }
};

/// Puts the scaled values of one frame or component through `take(value, voxel, survey)`.
template <class Take>
Survey passOver(const StoredVolume& stored, std::size_t frame, const Take& take) {
  const std::size_t voxels = stored.grid.voxelCount();
  const auto perVoxel = static_cast<std::size_t>(stored.valuesPerVoxel);
  const std::size_t step = stored.interleaved ? perVoxel : 1;
  const std::size_t start = stored.interleaved ? frame : frame * voxels;
  const bool scaled = stored.slope != 1 || stored.intercept != 0;
  Survey survey;
  withType(stored.type, [&]<class In>(const In*) {
    survey = parallelSum(voxels, kGrain, Survey{}, [&](std::size_t begin, std::size_t end) {
      Survey part;
      const std::uint8_t* from = stored.values.data() + (start + begin * step) * sizeof(In);
      for (std::size_t v = begin; v < end; ++v, from += step * sizeof(In)) {
        In value;
        std::memcpy(&value, from, sizeof(In));
        if (scaled) {
          take(static_cast<double>(value) * stored.slope + stored.intercept, v, part);
        } else {
          take(value, v, part);
        }
      }
      return part;
    });
  });
  return survey;
}

void checkFrameAndDimension(const StoredVolume& stored, const VolumeReadOptions& options,
                            std::int64_t valuesNeeded) {
  const VolumeOrigin& origin = stored.origin;
  const std::string size = sizeText(origin.storedSize);
  if (options.dimension && *options.dimension != stored.grid.dimension()) {
    refuse(origin.path,
           stored.grid.dimension() == 2
               ? "is two-dimensional (" + size + "); a volume of several slices is needed"
               : "is three-dimensional (" + size + "); a single slice is needed");
  }
  if (valuesNeeded == 3) {
    if (stored.valuesPerVoxel != 3) {
      refuse(origin.path, "holds " + std::to_string(stored.valuesPerVoxel) + " values a voxel (" +
                              size + "); three are needed");
    }
    return;
  }
  if (options.frame) {
    if (*options.frame < 0 || *options.frame >= stored.valuesPerVoxel) {
      refuse(origin.path, "holds " + std::to_string(stored.valuesPerVoxel) +
                              " volume(s); --frame " + std::to_string(*options.frame) +
                              " does not exist (0 to " + std::to_string(stored.valuesPerVoxel - 1) +
                              ")");
    }
  } else if (stored.valuesPerVoxel > 1) {
    refuse(origin.path, "holds " + std::to_string(stored.valuesPerVoxel) + " volumes (" + size +
                            "); choose one with --frame 0 to --frame " +
                            std::to_string(stored.valuesPerVoxel - 1));
  }
}

void checkValues(const StoredVolume& stored, const Survey& survey, const VolumeReadOptions& options,
                 const char* zero) {
  const VolumeOrigin& origin = stored.origin;
  if (survey.bad > 0 && !options.allowNonFinite) {
    refuse(origin.path, std::to_string(survey.bad) + " of " +
                            std::to_string(stored.grid.voxelCount()) +
                            " voxels are not a finite number, the first at " +
                            voxelText(stored.grid, survey.firstBad) +
                            "; replace NaN and infinity by numbers first");
  }
  if (survey.nonZero == 0 && !options.allowAllZero) {
    refuse(origin.path, std::string(zero) + "; is it the right file?");
  }
}

/// Scalars, or one component of vectors, into every `step`-th float.
Survey toFloats(const StoredVolume& stored, std::size_t frame, float* to, std::size_t step) {
  return passOver(stored, frame, [&](auto value, std::size_t v, Survey& survey) {
    const auto real = static_cast<float>(value);
    to[v * step] = real;
    survey.nonZero += real != 0;
    if (!std::isfinite(real)) survey.addBad(v);
  });
}

std::string allEndings() {
  std::string text;
  for (const VolumeFormat& format : volumeFormats()) {
    for (const VolumeEnding& ending : format.endings) {
      text += (text.empty() ? "" : ", ") + std::string(ending.text);
    }
  }
  return text;
}

/// How a volume is written under a name.
struct NamedLayout {
  const VolumeFormat& format;
  bool packed;
};

NamedLayout layoutFor(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  for (const VolumeFormat& format : volumeFormats()) {
    for (const VolumeEnding& ending : format.endings) {
      if (name.ends_with(ending.text)) return {format, ending.packed};
    }
  }
  throw InvalidInput("cannot tell the format of volume " + quoted(path) +
                     " from its name; end it in one of " + allEndings());
}

/// Puts bytes [begin, begin + count) of the values, component by component.
void fillBytes(const VolumeToWrite& volume, std::size_t begin, std::uint8_t* to,
               std::size_t count) {
  const std::size_t width = volume.elsewhere.size(), voxels = volume.grid.voxelCount();
  for (std::size_t value = begin / width, end = (begin + count) / width; value < end;) {
    const std::size_t voxel = value % voxels, run = std::min(end - value, voxels - voxel);
    volume.fill(static_cast<int>(value / voxels), voxel, run, to);
    value += run;
    to += run * width;
  }
}

/// True if bytes [begin, begin + count) of the values lie where the volume has one value only.
bool repeatsBlank(const VolumeToWrite& volume, std::size_t begin, std::size_t count) {
  const std::size_t width = volume.elsewhere.size(), voxels = volume.grid.voxelCount();
  const std::size_t first = begin / width, last = (begin + count) / width - 1;
  if (first / voxels != last / voxels) return false;
  return last % voxels < volume.begin || first % voxels >= volume.end;
}

void writeValues(const std::filesystem::path& path, VolumeToWrite volume) {
  const auto [format, packed] = layoutFor(path);
  volume.name = path.filename().string();
  volume.name.resize(volume.name.find('.', 1));
  const VolumeLayout& layout = *format.layout;
  if (volume.grid.voxelCount() == 0) {
    throw InvalidInput("volume for " + quoted(path) + ": it has no voxels");
  }
  const bool bigEndian = layout.bigEndian;
  const std::size_t width = volume.elsewhere.size();
  Content content;
  content.bodySize = volume.grid.voxelCount() * volume.valuesPerVoxel * width;
  content.body = [&, bigEndian, width](std::size_t begin, std::uint8_t* to, std::size_t count) {
    fillBytes(volume, begin, to, count);
    if (bigEndian) swapBytes(to, count / width, width);
  };
  content.blank = volume.elsewhere;
  if (bigEndian) swapBytes(content.blank.data(), 1, width);
  content.isBlank = [&](std::size_t begin, std::size_t count) {
    return repeatsBlank(volume, begin, count);
  };
  WholeFile file(path);
  content.head = layout.head(volume);
  if (layout.tail != nullptr) content.tail = layout.tail();
  (packed ? writeGzip : writePlain)(file, content);
  file.commit();
}

/// Components of type In, stored as Out.
template <class Out, class In>
VolumeToWrite stored(std::span<const VolumeOnDemand<In>> components, StoredType type) {
  VolumeToWrite values;
  values.grid = components[0].grid;
  values.type = type;
  values.valuesPerVoxel = static_cast<int>(components.size());
  append(values.elsewhere, static_cast<Out>(components[0].elsewhere), false);
  values.begin = values.grid.voxelCount();
  for (const VolumeOnDemand<In>& component : components) {
    values.begin = std::min(values.begin, component.begin);
    values.end = std::max(values.end, component.end);
  }
  values.fill = [components](int component, std::size_t first, std::size_t count,
                             std::uint8_t* to) {
    if constexpr (std::is_same_v<In, Out>) {
      components[component].fill(first, count, reinterpret_cast<In*>(to));
    } else {
      const auto made = std::make_unique_for_overwrite<In[]>(std::min(count, kPiece));
      for (std::size_t begin = 0; begin < count; begin += kPiece) {
        const std::size_t length = std::min(kPiece, count - begin);
        components[component].fill(first + begin, length, made.get());
        for (std::size_t v = 0; v < length; ++v) {
          store(to + (begin + v) * sizeof(Out), static_cast<Out>(made[v]), false);
        }
      }
    }
  };
  return values;
}

/// The values that an array holds.
template <class Out, class In>
VolumeOnDemand<Out> viewOf(const Volume<In>& volume) {
  VolumeOnDemand<Out> view;
  view.grid = volume.grid;
  view.end = volume.size();
  view.fill = [&volume](std::size_t first, std::size_t count, Out* to) {
    const In* from = volume.data.data() + first;
    for (std::size_t v = 0; v < count; ++v) to[v] = static_cast<Out>(from[v]);
  };
  return view;
}

struct LabelRange {
  Label lowest = 0, highest = 0;
  LabelRange& operator+=(const LabelRange& other) {
    lowest = std::min(lowest, other.lowest);
    highest = std::max(highest, other.highest);
    return *this;
  }
};

LabelRange rangeOf(const VolumeOnDemand<Label>& volume) {
  if (volume.range) return {(*volume.range)[0], (*volume.range)[1]};
  const LabelRange outside{std::min(volume.elsewhere, 0), std::max(volume.elsewhere, 0)};
  return parallelSum(volume.end - volume.begin, kGrain, outside,
                     [&](std::size_t begin, std::size_t end) {
                       const auto labels = std::make_unique_for_overwrite<Label[]>(kPiece);
                       LabelRange range = outside;
                       for (; begin < end; begin += kPiece) {
                         const std::size_t count = std::min(kPiece, end - begin);
                         volume.fill(volume.begin + begin, count, labels.get());
                         Label lowest = range.lowest, highest = range.highest;
                         for (std::size_t v = 0; v < count; ++v) {
                           lowest = std::min(lowest, labels[v]);
                           highest = std::max(highest, labels[v]);
                         }
                         range = {lowest, highest};
                       }
                       return range;
                     });
}

}  // namespace

std::size_t widthOf(StoredType type) {
  std::size_t width = 0;
  withType(type, [&]<class In>(const In*) { width = sizeof(In); });
  return width;
}

std::optional<StoredType> typeNamed(std::string_view name) {
  const std::string wanted = lowerCase(std::string(name));
  for (const auto& [type, word] : enumWords(StoredType{})) {
    if (word == wanted) return type;
  }
  return {};
}

std::vector<double> realsOf(ByteView raw, StoredType type, bool bigEndian) {
  std::vector<double> values(raw.size() / widthOf(type));
  withType(type, [&]<class In>(const In*) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = static_cast<double>(load<In>(raw.data() + i * sizeof(In), bigEndian));
    }
  });
  return values;
}

namespace {

/// Refuses sizes and places that no scanner or microscope gives: a header in other units, or torn.
void requireUsualPlace(const std::filesystem::path& path, const Grid& grid) {
  constexpr double kMostSpacing = 1e6;  // mm; its inverse is the least
  const auto number = [](double value) {
    std::ostringstream text;
    text << value;
    return text.str();
  };
  for (int axis = 0; axis < 3; ++axis) {
    const double spacing = grid.spacing[axis];
    if (spacing < 1 / kMostSpacing || spacing > kMostSpacing) {
      refuse(path, "its header gives a voxel size of " + number(spacing) +
                       " mm; sizes from 1e-6 to 1e6 mm are read");
    }
    if (std::abs(grid.origin[axis]) > kFarthest) {
      refuse(path, "its header places the first voxel " + number(std::abs(grid.origin[axis])) +
                       " mm from the origin; up to 1e7 mm are read");
    }
  }
}

}  // namespace

Grid gridOf(const std::filesystem::path& path, const std::array<int, 3>& size,
            const Eigen::Matrix4d& affine) {
  if (!affine.allFinite())
    refuse(path, "its header places the voxels at positions that are not finite");
  Grid grid;
  try {
    grid = gridFromAffine(size, affine);
  } catch (const InvalidInput& error) {
    refuse(path, error.what());
  }
  requireUsualPlace(path, grid);
  return grid;
}

std::int64_t checkedProduct(const std::filesystem::path& path,
                            const std::vector<std::int64_t>& sizes) {
  constexpr std::int64_t kMost = std::int64_t{1} << 40;  // values; beyond it a header is damaged
  std::int64_t product = 1;
  for (const std::int64_t size : sizes) {
    if (size < 1 || size > std::numeric_limits<std::int32_t>::max()) {
      failToRead(path, "its header gives a size of " + std::to_string(size) + " along one axis");
    }
    if (product > kMost / size)
      failToRead(path, "its header announces more voxels than can be held");
    product *= size;
  }
  return product;
}

StoredVolume readStored(const std::filesystem::path& path, const VolumeReadOptions& options,
                        Extent extent) {
  ByteSource source(openedFor(path));
  return readStored(source, path, options, extent);
}

std::filesystem::path openedFor(const std::filesystem::path& path) {
  std::filesystem::path opened = path;
  if (path.extension() == ".img") opened.replace_extension(".hdr");
  return isThere(opened) ? opened : path;
}

void scaledFloats(const StoredVolume& stored, const std::uint8_t* from, float* to) {
  const bool scaled = stored.slope != 1 || stored.intercept != 0;
  withType(stored.type, [&]<class In>(const In*) {
    parallelForBlocks(stored.grid.voxelCount(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        In value;
        std::memcpy(&value, from + v * sizeof(In), sizeof(In));
        to[v] =
            scaled
                ? static_cast<float>(static_cast<double>(value) * stored.slope + stored.intercept)
                : static_cast<float>(value);
      }
    });
  });
}

StoredVolume readStored(ByteSource& source, const std::filesystem::path& path,
                        const VolumeReadOptions& options, Extent extent) {
  const ByteView first = source.peek(kTellingBytes);
  for (const VolumeFormat& format : volumeFormats()) {
    if (format.looksLike(first)) return format.read(source, path, options, extent);
  }
  std::string names;
  for (const VolumeFormat& format : volumeFormats()) {
    if (format.name == std::string_view("MINC")) continue;  // known only to be refused
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  }
  failToRead(path, "is not an image of a known format (" + names + ")");
}

LoadedVolume<float> readScalars(const std::filesystem::path& path,
                                const VolumeReadOptions& options) {
  const StoredVolume stored = readStored(path, options, Extent::Everything);
  checkFrameAndDimension(stored, options, 1);
  LoadedVolume<float> loaded{Volume<float>(stored.grid), stored.origin};
  const Survey survey = toFloats(stored, options.frame.value_or(0), loaded.volume.data.data(), 1);
  checkValues(stored, survey, options, "every voxel is 0");
  return loaded;
}

namespace {

bool holdsByteLabels(const StoredVolume& stored) {
  return stored.type == StoredType::UInt8 && stored.slope == 1 && stored.intercept == 0 &&
         (!stored.interleaved || stored.valuesPerVoxel == 1);
}

/// Labels as most files have them: each array is gone through once, and none is filled beforehand.
LoadedVolume<Label> byteLabels(const StoredVolume& stored, const VolumeReadOptions& options) {
  const std::size_t voxels = stored.grid.voxelCount();
  const std::uint8_t* from = stored.values.data() + options.frame.value_or(0) * voxels;
  LoadedVolume<Label> loaded;
  loaded.volume.grid = stored.grid;
  loaded.volume.data.assign(from, from + voxels);
  loaded.origin = stored.origin;
  Survey survey;
  survey.nonZero = std::any_of(from, from + voxels, [](std::uint8_t v) { return v != 0; }) ? 1 : 0;
  checkValues(stored, survey, options, "every voxel has label 0");
  return loaded;
}

}  // namespace

LoadedVolume<Label> readLabels(const std::filesystem::path& path,
                               const VolumeReadOptions& options) {
  const StoredVolume stored = readStored(path, options, Extent::Everything);
  checkFrameAndDimension(stored, options, 1);
  if (holdsByteLabels(stored)) return byteLabels(stored, options);
  LoadedVolume<Label> loaded{Volume<Label>(stored.grid), stored.origin};
  Label* to = loaded.volume.data.data();
  const auto take = [to](auto value, std::size_t v, Survey& survey) {
    using Value = decltype(value);
    constexpr double kLowest = std::numeric_limits<Label>::lowest();
    constexpr double kHighest = std::numeric_limits<Label>::max();
    if constexpr (std::is_integral_v<Value> && sizeof(Value) < sizeof(Label)) {
      to[v] = static_cast<Label>(value);  // NOLINT(bugprone-signed-char-misuse): a number
    } else {
      const auto real = static_cast<double>(value);
      if (!(real >= kLowest && real <= kHighest && std::trunc(real) == real)) {
        survey.addBad(v);
        return;
      }
      to[v] = static_cast<Label>(value);
    }
    survey.nonZero += to[v] != 0;
  };
  const Survey survey = passOver(stored, options.frame.value_or(0), take);
  if (survey.bad > 0) {
    refuse(path, std::to_string(survey.bad) +
                     " voxels hold no whole number of 32 bits, the first at " +
                     voxelText(stored.grid, survey.firstBad) + "; labels are needed");
  }
  checkValues(stored, survey, options, "every voxel has label 0");
  return loaded;
}

LoadedVolume<Eigen::Vector3f> readVectors(const std::filesystem::path& path,
                                          const VolumeReadOptions& options) {
  const StoredVolume stored = readStored(path, options, Extent::Everything);
  checkFrameAndDimension(stored, options, 3);
  LoadedVolume<Eigen::Vector3f> loaded{
      Volume<Eigen::Vector3f>(stored.grid, Eigen::Vector3f::Zero()), stored.origin};
  Survey survey;
  for (std::size_t c = 0; c < 3; ++c) {
    survey += toFloats(stored, c, loaded.volume.data.data()->data() + c, 3);
  }
  checkValues(stored, survey, options, "every vector is 0");
  return loaded;
}

Grid readGrid(const std::filesystem::path& path, const VolumeReadOptions& options) {
  return readStored(path, options, Extent::Header).grid;
}

void writeVolume(const std::filesystem::path& path, const Volume<float>& volume) {
  writeVolume(path, viewOf<float>(volume));
}

void writeVolume(const std::filesystem::path& path, const Volume<double>& volume) {
  writeVolume(path, viewOf<float>(volume));
}

void writeVolume(const std::filesystem::path& path, const Volume<std::uint8_t>& volume) {
  const VolumeOnDemand<std::uint8_t> view = viewOf<std::uint8_t>(volume);
  writeValues(path, stored<std::uint8_t>(std::span(&view, 1), StoredType::UInt8));
}

void writeVolume(const std::filesystem::path& path, const Volume<Label>& volume) {
  writeVolume(path, viewOf<Label>(volume));
}

void writeVolume(const std::filesystem::path& path, const VolumeOnDemand<float>& volume) {
  writeValues(path, stored<float>(std::span(&volume, 1), StoredType::Float32));
}

void writeVolume(const std::filesystem::path& path, const VolumeOnDemand<Label>& volume) {
  const LabelRange range = rangeOf(volume);
  const std::span values(&volume, 1);
  if (range.lowest >= 0 && range.highest <= std::numeric_limits<std::uint8_t>::max()) {
    writeValues(path, stored<std::uint8_t>(values, StoredType::UInt8));
  } else if (range.lowest >= std::numeric_limits<std::int16_t>::lowest() &&
             range.highest <= std::numeric_limits<std::int16_t>::max()) {
    writeValues(path, stored<std::int16_t>(values, StoredType::Int16));
  } else {
    writeValues(path, stored<Label>(values, StoredType::Int32));
  }
}

void writeVolume(const std::filesystem::path& path, const Volume<Eigen::Vector3f>& volume) {
  VectorsOnDemand components;
  for (int c = 0; c < 3; ++c) {
    components[c].grid = volume.grid;
    components[c].end = volume.size();
    components[c].fill = [&volume, c](std::size_t first, std::size_t count, float* to) {
      const Eigen::Vector3f* from = volume.data.data() + first;
      for (std::size_t v = 0; v < count; ++v) to[v] = from[v][c];
    };
  }
  writeVolume(path, components);
}

void writeVolume(const std::filesystem::path& path, const VectorsOnDemand& volume) {
  VolumeToWrite values =
      stored<float>(std::span<const VolumeOnDemand<float>>(volume), StoredType::Float32);
  values.vectors = true;
  writeValues(path, values);
}

void writeFrames(const std::filesystem::path& path,
                 const std::vector<VolumeOnDemand<float>>& frames) {
  if (frames.empty()) throw InvalidInput("volume for " + quoted(path) + ": it has no frames");
  for (const VolumeOnDemand<float>& frame : frames) {
    if (frame.grid.size != frames.front().grid.size) {
      throw InvalidInput("volume for " + quoted(path) + ": its frames differ in size");
    }
  }
  writeValues(path, stored<float>(std::span(frames), StoredType::Float32));
}

}  // namespace explica::io
