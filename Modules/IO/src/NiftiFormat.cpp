// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Folders.h"
#include "VolumeFormats.h"

#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <optional>

namespace explica::io {
namespace {

constexpr std::size_t kHeader1 = 348;  // bytes of NIfTI-1's header
constexpr std::size_t kHeader2 = 540;  // bytes of NIfTI-2's header
constexpr double kAgreement = 0.01;    // voxels: q- and sform that round differently differ by 1e-4

/// The fields of either header version that matter here.
struct Header {
  int version = 1;
  bool bigEndian = false;
  bool pair = false;  ///< header and image in two files
  std::array<std::int64_t, 8> dim{};
  std::array<double, 8> pixdim{};
  int datatype = 0, bits = 0;
  double offset = 0;  ///< of the values in the file
  double slope = 0, intercept = 0;
  int units = 0, intent = 0;
  int qformCode = 0, sformCode = 0;
  std::array<double, 6> quaternion{};  ///< b, c, d, offsets x, y, z
  std::array<double, 12> srow{};
};

/// Visits each field with its byte and type in NIfTI-1, and those in NIfTI-2.
template <class Visit>
void forFields(Header& header, const Visit& visit) {
  using Short = std::int16_t;
  using Int = std::int32_t;
  using Long = std::int64_t;
  const auto numbers = [&](auto& row, std::size_t one, std::size_t two) {
    for (std::size_t n = 0; n < row.size(); ++n) {
      visit(row[n], one + 4 * n, float{}, two + 8 * n, double{});
    }
  };
  for (std::size_t n = 0; n < 8; ++n) visit(header.dim[n], 40 + 2 * n, Short{}, 16 + 8 * n, Long{});
  visit(header.intent, 68, Short{}, 504, Int{});
  visit(header.datatype, 70, Short{}, 12, Short{});
  visit(header.bits, 72, Short{}, 14, Short{});
  numbers(header.pixdim, 76, 104);
  visit(header.offset, 108, float{}, 168, Long{});
  visit(header.slope, 112, float{}, 176, double{});
  visit(header.intercept, 116, float{}, 184, double{});
  visit(header.units, 123, std::uint8_t{}, 500, Int{});
  visit(header.qformCode, 252, Short{}, 344, Int{});
  visit(header.sformCode, 254, Short{}, 348, Int{});
  numbers(header.quaternion, 256, 352);
  numbers(header.srow, 280, 400);
}

struct Detected {
  int version;
  bool bigEndian;
};

std::optional<Detected> detect(ByteView bytes) {
  if (bytes.size() < kHeader1) return {};
  for (const bool bigEndian : {false, true}) {
    const auto size = load<std::int32_t>(bytes.data(), bigEndian);
    if (size == static_cast<std::int32_t>(kHeader1)) return Detected{1, bigEndian};
    if (size == static_cast<std::int32_t>(kHeader2)) return Detected{2, bigEndian};
  }
  return {};
}

Header parse(const std::filesystem::path& path, const Bytes& bytes, const Detected& detected) {
  Header header;
  header.version = detected.version;
  header.bigEndian = detected.bigEndian;
  const bool one = header.version == 1;
  const std::string_view magic = textOf(bytes).substr(one ? 344 : 4, 3);
  header.pair = magic == (one ? "ni1" : "ni2");
  if (!header.pair && magic != (one ? "n+1" : "n+2")) {
    failToRead(path,
               "is an Analyze header or a damaged NIfTI header (no NIfTI signature); Analyze files "
               "do not say which side is left: convert to NIfTI");
  }
  forFields(header, [&]<class Value, class One, class Two>(Value& value, std::size_t at1, One,
                                                           std::size_t at2, Two) {
    value = one ? static_cast<Value>(load<One>(bytes.data() + at1, header.bigEndian))
                : static_cast<Value>(load<Two>(bytes.data() + at2, header.bigEndian));
  });
  constexpr double kFarthest = 0x1p63;  // no place in a file has this number
  header.offset = std::abs(header.offset) < kFarthest ? std::floor(header.offset) : -1;
  return header;
}

struct NiftiType {
  int code;
  StoredType type;
};
// The codes of nifti1.h's NIFTI_TYPE_*.
constexpr NiftiType kNiftiTypes[] = {{2, StoredType::UInt8},    {4, StoredType::Int16},
                                     {8, StoredType::Int32},    {16, StoredType::Float32},
                                     {64, StoredType::Float64}, {256, StoredType::Int8},
                                     {512, StoredType::UInt16}, {768, StoredType::UInt32},
                                     {1024, StoredType::Int64}, {1280, StoredType::UInt64}};

StoredType typeOf(const std::filesystem::path& path, int code) {
  for (const NiftiType& row : kNiftiTypes) {
    if (row.code == code) return row.type;
  }
  switch (code) {
    case 128:
    case 2304:
      refuse(path, "holds colours; a volume of scalars is needed");
    case 32:
    case 1792:
    case 2048:
      refuse(path, "holds complex numbers; a volume of scalars is needed");
    case 1536:
      refuse(path, "holds 128-bit numbers; convert it to float32");
    default:
      failToRead(path, "has the unknown NIfTI data type " + std::to_string(code));
  }
}

/// Voxel sizes, in mm; a missing third one of a single slice is 1.
Vector spacingOf(const std::filesystem::path& path, const Header& header,
                 const std::array<int, 3>& size, double unit) {
  Vector spacing;
  for (int axis = 0; axis < 3; ++axis) {
    double width = header.pixdim[axis + 1];
    if (size[axis] == 1 && axis == 2 && width == 0) width = 1;
    if (!(width > 0) || !std::isfinite(width)) {
      refuse(path, "its header gives a voxel size of " + std::to_string(width) + " along axis " +
                       std::to_string(axis) + "; correct the header (pixdim)");
    }
    spacing[axis] = width * unit;
  }
  return spacing;
}

/// The rotation that a qform's b, c, d stand for.  Its real part is the root of a difference that
/// float32 rounding leaves uncertain by 1e-7: below that it is 0, as NIfTI's own library has it.
Eigen::Quaterniond rotationOf(const Vector& bcd) {
  constexpr double kRounding = 1e-7;  // of float32 in a quaternion
  const double rest = 1 - bcd.squaredNorm();
  Eigen::Quaterniond rotation(rest < kRounding ? 0 : std::sqrt(rest), bcd[0], bcd[1], bcd[2]);
  rotation.normalize();
  return rotation;
}

/// The b, c, d in float32 from which readers get the rotation back best: of the neighbours of the
/// rounded ones, since the real part follows from them and amplifies their rounding near half
/// turns (FreeSurfer's axes are one).  Readers that do not know NIfTI's rule for a real part near 0
/// are served too.
Vector storedQuaternion(const Eigen::Quaterniond& rotation) {
  constexpr int kReach = 2;  // units in the last place
  const auto neighbour = [](double value, int steps) {
    auto number = static_cast<float>(value);
    for (int step = 0; step < std::abs(steps); ++step) {
      number = std::nextafter(number, steps > 0 ? 2.0F : -2.0F);
    }
    return static_cast<double>(number);
  };
  const Vector wanted = rotation.vec();
  Vector best = wanted;
  double least = std::numeric_limits<double>::infinity();
  for (int code = 0; code < 125; ++code) {
    Vector bcd;
    for (int axis = 0, rest = code; axis < 3; ++axis, rest /= 5) {
      bcd[axis] = wanted[axis] == 0 ? 0 : neighbour(wanted[axis], rest % 5 - kReach);
    }
    const double real = std::sqrt(std::max(0.0, 1 - bcd.squaredNorm()));
    const double error = std::abs(real - rotation.w()) + (bcd - wanted).norm();
    if (error >= least) continue;
    least = error;
    best = bcd;
  }
  return best;
}

Eigen::Matrix4d qformOf(const std::filesystem::path& path, const Header& header,
                        const Vector& spacing, double unit) {
  const Vector bcd(header.quaternion[0], header.quaternion[1], header.quaternion[2]);
  const double square = bcd.squaredNorm();
  constexpr double kLongest = 1 + 1e-4;  // float32 rounding stays below
  if (!(square <= kLongest)) {
    refuse(path,
           "the quaternion of its qform is no rotation; correct the header or use --xform sform");
  }
  const Eigen::Quaterniond rotation = rotationOf(bcd);
  Eigen::Matrix4d affine = Eigen::Matrix4d::Identity();
  affine.topLeftCorner<3, 3>() = rotation.toRotationMatrix() * spacing.asDiagonal();
  if (header.pixdim[0] < 0) affine.col(2) *= -1;
  for (int axis = 0; axis < 3; ++axis) affine(axis, 3) = header.quaternion[axis + 3] * unit;
  return affine;
}

Eigen::Matrix4d sformOf(const Header& header, const std::array<int, 3>& size, double unit) {
  Eigen::Matrix4d affine = Eigen::Matrix4d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column)
      affine(row, column) = header.srow[4 * row + column] * unit;
  }
  const Vector normal = affine.block<3, 1>(0, 0).cross(affine.block<3, 1>(0, 1));
  if (size[2] == 1 && affine.block<3, 1>(0, 2).isZero(0) && normal.norm() > 0) {
    affine.block<3, 1>(0, 2) = normal.normalized();
  }
  return affine;
}

/// Largest distance between two placements of the corner voxels, in voxels of the smallest size.
double disagreement(const Eigen::Matrix4d& a, const Eigen::Matrix4d& b,
                    const std::array<int, 3>& size) {
  double worst = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector4d index((corner & 1) ? size[0] : 0, (corner & 2) ? size[1] : 0,
                                (corner & 4) && size[2] > 1 ? size[2] : 0, 1);
    const double distance = (a * index - b * index).norm();
    if (!(distance <= worst)) worst = distance;
  }
  const double smallest = a.block<3, 3>(0, 0).colwise().norm().minCoeff();
  return worst / smallest;
}

Eigen::Matrix4d place(const Header& header, const std::array<int, 3>& size, PlacementChoice choice,
                      VolumeOrigin& origin) {
  double unit = 1;
  const int lengthUnit = header.units & 7;
  if (lengthUnit == 1 || lengthUnit == 3) {
    unit = lengthUnit == 1 ? 1000 : 0.001;
    origin.notes.push_back(std::string("header lengths in ") +
                           (lengthUnit == 1 ? "metres" : "micrometres") + ", converted to mm");
  }
  const std::filesystem::path& path = origin.path;
  const bool hasQ = header.qformCode > 0;
  const bool hasS = header.sformCode > 0;
  origin.qformCode = header.qformCode;
  origin.sformCode = header.sformCode;
  const std::string codes = "qform code " + std::to_string(header.qformCode) + ", sform code " +
                            std::to_string(header.sformCode);
  const auto qform = [&] {
    return qformOf(path, header, spacingOf(path, header, size, unit), unit);
  };
  if (hasQ && hasS && (choice == PlacementChoice::Qform || choice == PlacementChoice::Sform)) {
    const double apart = disagreement(qform(), sformOf(header, size, unit), size);
    if (!(apart <= kAgreement)) origin.placementsApart = apart;
  }
  switch (choice) {
    case PlacementChoice::Qform:
      if (!hasQ) refuse(path, "has no qform (" + codes + "); use --xform sform");
      origin.placement = "qform";
      return qform();
    case PlacementChoice::Sform:
      if (!hasS) refuse(path, "has no sform (" + codes + "); use --xform qform");
      origin.placement = "sform";
      return sformOf(header, size, unit);
    case PlacementChoice::None: {
      origin.placement = kNotPlaced;
      Eigen::Matrix4d affine = Eigen::Matrix4d::Identity();
      affine.diagonal().head<3>() = spacingOf(path, header, size, unit);
      return affine;
    }
    case PlacementChoice::Agreed:
      break;
  }
  if (!hasQ && !hasS) {
    refuse(path,
           "does not say where its voxels lie (qform and sform codes are 0), and programs differ "
           "on what to assume; set its header, or use --xform none for voxel (0, 0, 0) at 0 and "
           "axes along right, anterior, superior");
  }
  if (!hasS) {
    origin.placement = "qform";
    return qform();
  }
  Eigen::Matrix4d sform = sformOf(header, size, unit);
  if (!hasQ) {
    origin.placement = "sform";
    return sform;
  }
  const double apart = disagreement(qform(), sform, size);
  if (!(apart <= kAgreement)) {
    refuse(path, "its qform and sform place the voxels differently (by up to " +
                     std::to_string(apart) + " voxels; " + codes +
                     "), and programs differ on which to believe; choose with --xform qform or "
                     "--xform sform");
  }
  origin.placement = "sform and qform agree";
  return sform;
}

/// Seconds from frame to frame, where the header gives a time and its unit.
std::optional<double> frameSecondsOf(const Header& header) {
  const double step = header.pixdim[4];
  if (header.dim[0] < 4 || !(step > 0) || !std::isfinite(step)) return {};
  switch (header.units & 0x38) {
    case 8:
      return step;
    case 16:
      return 1e-3 * step;
    case 24:
      return 1e-6 * step;
    default:
      return {};
  }
}

std::filesystem::path imageOfPair(const std::filesystem::path& header) {
  std::string stem = header.string();
  for (const std::string_view ending : {".gz", ".hdr", ".img"}) {
    if (stem.ends_with(ending)) stem.resize(stem.size() - ending.size());
  }
  for (const char* ending : {".img", ".img.gz"}) {
    if (isThere(stem + ending)) return stem + ending;
  }
  failToRead(header, "is a NIfTI header without its image '" + stem + ".img'");
}

}  // namespace

bool looksLikeNifti(ByteView firstBytes) {
  return detect(firstBytes).has_value();
}

StoredVolume readNifti(ByteSource& source, const std::filesystem::path&,
                       const VolumeReadOptions& options, Extent extent) {
  const std::filesystem::path& path = source.path();
  Bytes first = source.take(kHeader1);
  const std::optional<Detected> detected = detect(first);
  if (!detected) failToRead(path, "is not a NIfTI file");
  if (detected->version == 2) {
    const Bytes more = source.take(kHeader2 - kHeader1);
    first.insert(first.end(), more.begin(), more.end());
  }
  const Header header = parse(path, first, *detected);

  StoredVolume volume;
  volume.origin.path = path;
  volume.origin.format = header.version == 1 ? "NIfTI-1" : "NIfTI-2";
  if (header.dim[0] < 1 || header.dim[0] > 7) {
    failToRead(path, "its header announces " + std::to_string(header.dim[0]) + " dimensions");
  }
  std::vector<std::int64_t> sizes(header.dim.begin() + 1, header.dim.begin() + 1 + header.dim[0]);
  const std::int64_t valueCount = checkedProduct(path, sizes);
  volume.origin.storedSize.assign(sizes.begin(), sizes.end());
  sizes.resize(std::max<std::size_t>(sizes.size(), 3), 1);
  const std::array<int, 3> size = {static_cast<int>(sizes[0]), static_cast<int>(sizes[1]),
                                   static_cast<int>(sizes[2])};
  volume.valuesPerVoxel = valueCount / (sizes[0] * sizes[1] * sizes[2]);
  volume.type = typeOf(path, header.datatype);
  volume.origin.storedType = nameOf(volume.type);
  // 0, and as in the library of NIfTI not-a-number: the values are as stored.
  if (header.slope != 0 && !std::isnan(header.slope)) {
    if (!std::isfinite(header.slope) || !std::isfinite(header.intercept)) {
      refuse(path, "its header scales values by " + std::to_string(header.slope) + " and adds " +
                       std::to_string(header.intercept) + "; correct scl_slope and scl_inter");
    }
    volume.slope = header.slope;
    volume.intercept = header.intercept;
  }
  const Eigen::Matrix4d affine = place(header, size, options.placement, volume.origin);
  volume.grid = gridOf(path, size, affine);
  volume.origin.affine = affine;
  volume.bigEndian = header.bigEndian;
  volume.frameSeconds = frameSecondsOf(header);
  if (extent == Extent::Header) return volume;

  const std::size_t width = widthOf(volume.type);
  const auto readValues = [&](ByteSource& from, std::uint64_t skipped) {
    from.skip(skipped);
    volume.values = from.take(static_cast<std::uint64_t>(valueCount) * width);
    if (const std::uint64_t left = from.finish(); left > 0) {
      volume.origin.notes.push_back(std::to_string(left) +
                                    " bytes after the last value are not used");
    }
  };
  if (header.pair) {
    ByteSource image(imageOfPair(path));
    readValues(image, static_cast<std::uint64_t>(std::max(header.offset, 0.0)));
  } else {
    const auto read = static_cast<std::int64_t>(first.size());
    const std::int64_t least = read + 4;  // four bytes say whether extensions follow
    const auto offset = static_cast<std::int64_t>(header.offset);
    if (offset != 0 && offset < least) {
      failToRead(path, "its header places the data inside the header (vox_offset " +
                           std::to_string(offset) + ")");
    }
    // Some writers leave the offset at 0 and mean the usual place.
    const std::int64_t start = offset == 0 ? least : offset;
    if (extent == Extent::Positioned) {
      source.skip(static_cast<std::uint64_t>(start - read));
      return volume;
    }
    readValues(source, static_cast<std::uint64_t>(start - read));
  }
  if (header.bigEndian) swapBytes(volume.values.data(), valueCount, width);
  return volume;
}

Bytes niftiHeader(const VolumeToWrite& volume) {
  const Grid& grid = volume.grid;
  const bool one = *std::ranges::max_element(grid.size) <= std::numeric_limits<std::int16_t>::max();
  constexpr std::size_t kExtensionFlag = 4;  // four zeros: no extension follows
  Bytes bytes((one ? kHeader1 : kHeader2) + kExtensionFlag);
  Header header;
  header.offset = static_cast<double>(bytes.size());
  // Vectors stand along the fifth dimension, frames along the fourth.
  const bool vectors = volume.vectors && volume.valuesPerVoxel > 1;
  const int dimensions = vectors ? 5 : volume.valuesPerVoxel > 1 ? 4 : 3;
  const int frames = vectors ? 1 : volume.valuesPerVoxel;
  const int components = vectors ? volume.valuesPerVoxel : 1;
  header.dim = {dimensions, grid.size[0], grid.size[1], grid.size[2], frames, components, 1, 1};
  for (const NiftiType& row : kNiftiTypes) {
    if (row.type == volume.type) header.datatype = row.code;
  }
  header.bits = static_cast<int>(8 * widthOf(volume.type));
  header.slope = 1;
  // qform: a rotation, and a sign for grids whose axes are left-handed.
  Eigen::Matrix3d axes = grid.direction;
  const double handedness = axes.determinant() < 0 ? -1 : 1;
  axes.col(2) *= handedness;
  Eigen::Quaterniond rotation(axes);
  rotation.normalize();
  if (rotation.w() < 0) rotation.coeffs() *= -1;
  header.pixdim = {handedness, grid.spacing[0], grid.spacing[1], grid.spacing[2], 1, 1, 1, 1};
  const Vector bcd = one ? storedQuaternion(rotation) : Vector(rotation.vec());
  header.quaternion = {bcd[0], bcd[1], bcd[2], grid.origin[0], grid.origin[1], grid.origin[2]};
  const Eigen::Matrix4d affine = grid.affine();
  Eigen::Matrix4d qform = affine;
  qform.topLeftCorner<3, 3>() = rotationOf(bcd).toRotationMatrix() * grid.spacing.asDiagonal();
  qform.col(2) *= handedness;
  for (int i = 0; i < 12; ++i) header.srow[i] = affine(i / 4, i % 4);

  // NIfTI's codes of millimetres, of the scanner's frame, and of what the values are.
  constexpr int kMillimetres = 2, kScanner = 1, kLabelIntent = 1002, kVectorIntent = 1007;
  header.units = kMillimetres;
  header.sformCode = kScanner;
  if (disagreement(qform, affine, grid.size) < 0.5 * kAgreement) header.qformCode = kScanner;
  const bool labels = volume.type != StoredType::Float32 && volume.type != StoredType::Float64;
  header.intent = vectors ? kVectorIntent : labels ? kLabelIntent : 0;
  forFields(header, [&]<class Value, class One, class Two>(Value& value, std::size_t at1, One,
                                                           std::size_t at2, Two) {
    if (one) {
      store(bytes.data() + at1, static_cast<One>(value), false);
    } else {
      store(bytes.data() + at2, static_cast<Two>(value), false);
    }
  });
  store(bytes.data(), static_cast<std::int32_t>(one ? kHeader1 : kHeader2), false);
  const auto putText = [&](std::size_t at, std::string_view text) {
    std::memcpy(bytes.data() + at, text.data(), text.size());
  };
  putText(one ? 344 : 4, one ? std::string_view("n+1", 4) : std::string_view("n+2\0\r\n\032\n", 8));
  putText(one ? 148 : 240, "Explica");
  constexpr std::size_t kNameLength = 15;  // bytes that NIfTI has for the name, and a zero
  putText(one ? 328 : 508, std::string_view(volume.name).substr(0, kNameLength));
  return bytes;
}

}  // namespace explica::io
