// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "MincFormat.h"

#include "Hdf5File.h"
#include "MincStore.h"
#include "NetcdfFile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <type_traits>

namespace explica::io {
namespace {

using Path = std::filesystem::path;

/// MINC 2: arrays of HDF5 in the groups of MINC's library.
class Minc2 : public MincStore {
 public:
  Minc2(const Path& path, ByteView bytes) : path_(path), file_(path, bytes) {
    for (const char* name : {"image", "image-max", "image-min"}) {
      add(name, std::string("/minc-2.0/image/0/") + name);
    }
    for (const char* name : {"xspace", "yspace", "zspace"}) {
      add(name, std::string("/minc-2.0/dimensions/") + name);
    }
  }
  [[nodiscard]] const MincArray* find(const std::string& name) const override {
    const auto found = arrays_.find(name);
    return found == arrays_.end() ? nullptr : &found->second.second;
  }
  [[nodiscard]] Bytes valuesOf(const std::string& name) const override {
    return file_.valuesOf(arrays_.at(name).first);
  }

 private:
  void add(const std::string& name, const std::string& place) {
    std::optional<Hdf5Array> found = file_.find(place);
    if (!found) return;
    MincArray array;
    array.size = found->size;
    array.type = found->type;
    for (const auto& [key, value] : found->attributes) {
      array.attributes[key] = {value.text, value.numbers};
    }
    // "zspace,yspace,xspace"
    std::string names = array.attributes["dimorder"].text;
    for (std::size_t at = 0; at < names.size();) {
      const std::size_t end = std::min(names.find(',', at), names.size());
      array.dimensions.push_back(names.substr(at, end - at));
      at = end + 1;
    }
    arrays_[name] = {std::move(*found), std::move(array)};
  }

  Path path_;
  Hdf5File file_;
  std::map<std::string, std::pair<Hdf5Array, MincArray>> arrays_;
};

/// Where the dimensions of an image stand among those of the file.
struct Axes {
  std::vector<std::string> space;  ///< three, slowest first
  std::int64_t frames = 1, components = 1;
  std::array<int, 3> size = {1, 1, 1};  ///< i, j, k: fastest first
};

Axes axesOf(const Path& path, const MincArray& image) {
  if (image.dimensions.size() != image.size.size()) {
    failToRead(path, "is damaged: its image has " + std::to_string(image.size.size()) +
                         " dimensions, but names " + std::to_string(image.dimensions.size()));
  }
  Axes axes;
  std::string names;
  bool proper = true;
  for (std::size_t d = 0; d < image.dimensions.size(); ++d) {
    const std::string& name = image.dimensions[d];
    names += (d > 0 ? ", " : "") + name;
    if (name == "xspace" || name == "yspace" || name == "zspace") {
      axes.space.push_back(name);
    } else if (name == "time" && d == 0) {
      axes.frames = image.size[d];
    } else if (name == "vector_dimension" && d + 1 == image.dimensions.size()) {
      axes.components = image.size[d];
    } else {
      proper = false;
    }
  }
  std::vector<std::string> distinct = axes.space;
  std::sort(distinct.begin(), distinct.end());
  proper = proper && distinct == std::vector<std::string>{"xspace", "yspace", "zspace"} &&
           (axes.frames == 1 || axes.components == 1);
  if (!proper) {
    refuse(path, "has the dimensions " + names +
                     "; xspace, yspace and zspace are needed, with time before them or "
                     "vector_dimension after them");
  }
  const std::size_t first = image.dimensions[0] == "time" ? 1 : 0;
  for (std::size_t a = 0; a < 3; ++a) {
    axes.size[2 - a] = static_cast<int>(image.size[first + a]);
  }
  return axes;
}

double numberOr(const MincArray& array, const char* key, double otherwise) {
  const auto found = array.attributes.find(key);
  if (found == array.attributes.end() || found->second.numbers.empty()) return otherwise;
  return found->second.numbers[0];
}

Eigen::Matrix4d affineOf(const Path& path, const MincStore& store, const Axes& axes) {
  Eigen::Matrix4d affine = Eigen::Matrix4d::Identity();
  affine.topRightCorner<3, 1>().setZero();
  for (int column = 0; column < 3; ++column) {
    const std::string& name = axes.space[2 - column];
    Vector direction = Vector::Unit(name[0] - 'x');
    double start = 0, step = 1;
    if (const MincArray* dimension = store.find(name)) {
      const auto spacing = dimension->attributes.find("spacing");
      if (spacing != dimension->attributes.end() &&
          spacing->second.text.find("irregular") != std::string::npos) {
        refuse(path,
               "its slices along " + name + " are not evenly spaced; resample it (mincresample)");
      }
      start = numberOr(*dimension, "start", 0);
      step = numberOr(*dimension, "step", 1);
      const auto cosines = dimension->attributes.find("direction_cosines");
      if (cosines != dimension->attributes.end() && cosines->second.numbers.size() == 3) {
        direction = Vector::Map(cosines->second.numbers.data());
      }
    }
    affine.block<3, 1>(0, column) = direction * step;
    affine.topRightCorner<3, 1>() += direction * start;
  }
  return affine;
}

/// Doubles of an array that is small or as large as the image's slices.
std::vector<double> doublesOf(const MincStore& store, const std::string& name) {
  const StoredType type = store.find(name)->type;
  const Bytes bytes = store.valuesOf(name);
  std::vector<double> values;
  const auto take = [&]<class In>(const In*) {
    for (std::size_t at = 0; at + sizeof(In) <= bytes.size(); at += sizeof(In)) {
      values.push_back(static_cast<double>(load<In>(bytes.data() + at, false)));
    }
  };
  withType(type, take);
  return values;
}

/// Whole numbers between two ends, which stand for two real values in each slice.
struct Scaling {
  double lowest = 0, highest = 1;
  std::vector<double> least, most;  ///< real values, by slice

  [[nodiscard]] bool isIdentity() const {
    const auto all = [](const std::vector<double>& values, double wanted) {
      return std::all_of(values.begin(), values.end(), [&](double v) { return v == wanted; });
    };
    return all(least, lowest) && all(most, highest);
  }
};

/// The values that a type can hold, or those that the header calls valid.
std::pair<double, double> validRangeOf(const MincArray& image) {
  std::pair<double, double> range;
  withType(image.type, [&]<class In>(const In*) {
    range = {static_cast<double>(std::numeric_limits<In>::lowest()),
             static_cast<double>(std::numeric_limits<In>::max())};
  });
  const auto said = image.attributes.find("valid_range");
  if (said != image.attributes.end() && said->second.numbers.size() == 2) {
    const double a = said->second.numbers[0], b = said->second.numbers[1];
    return {std::max(range.first, std::min(a, b)), std::min(range.second, std::max(a, b))};
  }
  return {std::max(range.first, numberOr(image, "valid_min", range.first)),
          std::min(range.second, numberOr(image, "valid_max", range.second))};
}

std::optional<Scaling> scalingOf(const Path& path, const MincStore& store, const MincArray& image) {
  const bool real = image.type == StoredType::Float32 || image.type == StoredType::Float64;
  const MincArray* most = store.find("image-max");
  const MincArray* least = store.find("image-min");
  if (real || most == nullptr || least == nullptr) return {};
  Scaling scaling;
  std::tie(scaling.lowest, scaling.highest) = validRangeOf(image);
  scaling.least = doublesOf(store, "image-min");
  scaling.most = doublesOf(store, "image-max");
  const auto voxels = static_cast<std::size_t>(valueCount(path, image));
  const bool fits = scaling.least.size() == scaling.most.size() && !scaling.least.empty() &&
                    voxels % scaling.least.size() == 0 && most->size.size() < image.size.size() &&
                    std::equal(most->size.begin(), most->size.end(), image.size.begin());
  if (!fits || !(scaling.lowest < scaling.highest)) {
    failToRead(path, "is damaged: image-min, image-max and valid_range do not scale its image");
  }
  return scaling;
}

/// Real values; those that lie within rounding of a whole number are whole, so that labels stay so.
Bytes scaled(const Bytes& values, StoredType type, const Scaling& scaling) {
  constexpr double kRounding = 1e-9;  // of the value: far above doubles', far below a stored step's
  Bytes result(values.size() / widthOf(type) * sizeof(double));
  withType(type, [&]<class In>(const In*) {
    const std::size_t count = values.size() / sizeof(In);
    const std::size_t slice = count / scaling.least.size();
    for (std::size_t v = 0; v < count; ++v) {
      const auto stored = static_cast<double>(load<In>(values.data() + v * sizeof(In), false));
      const double low = scaling.least[v / slice], high = scaling.most[v / slice];
      const double share = (std::clamp(stored, scaling.lowest, scaling.highest) - scaling.lowest) /
                           (scaling.highest - scaling.lowest);
      double real = low + share * (high - low);
      const double whole = std::round(real);
      if (std::abs(real - whole) <= kRounding * std::max(1.0, std::abs(real))) real = whole;
      store(result.data() + v * sizeof(double), real, false);
    }
  });
  return result;
}

std::unique_ptr<MincStore> storeOf(const Path& path, ByteView bytes) {
  if (looksLikeNetcdf(bytes)) return std::make_unique<NetcdfFile>(path, bytes);
  return std::make_unique<Minc2>(path, bytes);
}

}  // namespace

std::int64_t valueCount(const Path& path, const MincArray& array) {
  return array.size.empty() ? 1 : checkedProduct(path, array.size);
}

bool looksLikeMinc(ByteView firstBytes) {
  return looksLikeNetcdf(firstBytes) || looksLikeHdf5(firstBytes);
}

StoredVolume readMinc(ByteSource& source, const Path& path, Extent extent) {
  const Bytes bytes = source.rest();
  const std::unique_ptr<MincStore> store = storeOf(path, bytes);
  const MincArray* image = store->find("image");
  if (image == nullptr) {
    failToRead(path, "holds no MINC image (it is a netCDF or HDF5 file of another kind)");
  }
  static_cast<void>(valueCount(path, *image));
  const Axes axes = axesOf(path, *image);
  StoredVolume volume;
  volume.origin.path = path;
  volume.origin.format = looksLikeNetcdf(bytes) ? "MINC 1" : "MINC 2";
  volume.origin.placement = "header";
  volume.origin.storedType = nameOf(image->type);
  for (auto n = image->size.rbegin(); n != image->size.rend(); ++n) {
    volume.origin.storedSize.push_back(static_cast<int>(*n));
  }
  volume.type = image->type;
  volume.valuesPerVoxel = axes.frames * axes.components;
  volume.interleaved = axes.components > 1;
  volume.origin.affine = affineOf(path, *store, axes);
  volume.grid = gridOf(path, axes.size, volume.origin.affine);
  if (extent == Extent::Header) return volume;
  volume.values = store->valuesOf("image");
  const std::optional<Scaling> scaling = scalingOf(path, *store, *image);
  if (scaling && !scaling->isIdentity()) {
    volume.values = scaled(volume.values, volume.type, *scaling);
    volume.type = StoredType::Float64;
  }
  return volume;
}

}  // namespace explica::io
