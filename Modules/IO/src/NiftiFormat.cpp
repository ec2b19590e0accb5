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
  int datatype = 0;
  std::int64_t offset = 0;
  double slope = 0, intercept = 0;
  int units = 0;
  int qformCode = 0, sformCode = 0;
  std::array<double, 6> quaternion{};  ///< b, c, d, offsets x, y, z
  std::array<double, 12> srow{};
};

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

/// NIfTI-1's offset of the values, a float; -1 for one that is no place in a file.
std::int64_t wholeOffset(float offset) {
  constexpr float kFarthest = 1e15F;
  return offset >= 0 && offset <= kFarthest ? static_cast<std::int64_t>(offset) : -1;
}

Header parse(const std::filesystem::path& path, const Bytes& bytes, const Detected& detected) {
  Header header;
  header.version = detected.version;
  header.bigEndian = detected.bigEndian;
  const auto at = [&]<class T>(std::size_t offset, T) {
    return load<T>(bytes.data() + offset, header.bigEndian);
  };
  const bool one = header.version == 1;
  const char* magic = reinterpret_cast<const char*>(bytes.data()) + (one ? 344 : 4);
  header.pair = std::memcmp(magic, one ? "ni1" : "ni2", 3) == 0;
  if (!header.pair && std::memcmp(magic, one ? "n+1" : "n+2", 3) != 0) {
    failToRead(path,
               "is an Analyze header or a damaged NIfTI header (no NIfTI signature); Analyze files "
               "do not say which side is left: convert to NIfTI");
  }
  for (std::size_t i = 0; i < 8; ++i) {
    header.dim[i] = one ? at(40 + 2 * i, std::int16_t{}) : at(16 + 8 * i, std::int64_t{});
    header.pixdim[i] = one ? at(76 + 4 * i, float{}) : at(104 + 8 * i, double{});
  }
  header.datatype = at(one ? 70 : 12, std::int16_t{});
  header.offset = one ? wholeOffset(at(108, float{})) : at(168, std::int64_t{});
  header.slope = one ? at(112, float{}) : at(176, double{});
  header.intercept = one ? at(116, float{}) : at(184, double{});
  header.units = one ? bytes[123] : at(500, std::int32_t{});
  header.qformCode = one ? at(252, std::int16_t{}) : at(344, std::int32_t{});
  header.sformCode = one ? at(254, std::int16_t{}) : at(348, std::int32_t{});
  for (std::size_t i = 0; i < 6; ++i) {
    header.quaternion[i] = one ? at(256 + 4 * i, float{}) : at(352 + 8 * i, double{});
  }
  for (std::size_t i = 0; i < 12; ++i) {
    header.srow[i] = one ? at(280 + 4 * i, float{}) : at(400 + 8 * i, double{});
  }
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
    readValues(image, static_cast<std::uint64_t>(std::max<std::int64_t>(header.offset, 0)));
  } else {
    const auto read = static_cast<std::int64_t>(first.size());
    const std::int64_t least = read + 4;  // four bytes say whether extensions follow
    if (header.offset != 0 && header.offset < least) {
      failToRead(path, "its header places the data inside the header (vox_offset " +
                           std::to_string(header.offset) + ")");
    }
    // Some writers leave the offset at 0 and mean the usual place.
    const std::int64_t start = header.offset == 0 ? least : header.offset;
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
  const auto put = [&](std::size_t at, auto value) { store(bytes.data() + at, value, false); };
  const auto real = [&](std::size_t at1, std::size_t at2, double value) {
    if (one) {
      put(at1, static_cast<float>(value));
    } else {
      put(at2, value);
    }
  };
  put(0, static_cast<std::int32_t>(one ? kHeader1 : kHeader2));
  std::memcpy(bytes.data() + (one ? 344 : 4), one ? "n+1\0" : "n+2\0\r\n\032\n", one ? 4 : 8);

  // Vectors stand along the fifth dimension, frames along the fourth.
  const bool vectors = volume.vectors && volume.valuesPerVoxel > 1;
  const int dimensions = vectors ? 5 : volume.valuesPerVoxel > 1 ? 4 : 3;
  const int frames = vectors ? 1 : volume.valuesPerVoxel;
  const int components = vectors ? volume.valuesPerVoxel : 1;
  const std::array<std::int64_t, 8> dim = {
      dimensions, grid.size[0], grid.size[1], grid.size[2], frames, components, 1, 1};
  for (std::size_t i = 0; i < 8; ++i) {
    if (one) {
      put(40 + 2 * i, static_cast<std::int16_t>(dim[i]));
    } else {
      put(16 + 8 * i, dim[i]);
    }
  }
  for (const NiftiType& row : kNiftiTypes) {
    if (row.type != volume.type) continue;
    put(one ? 70 : 12, static_cast<std::int16_t>(row.code));
    put(one ? 72 : 14, static_cast<std::int16_t>(8 * widthOf(row.type)));
  }
  // qform: a rotation, and a sign for grids whose axes are left-handed.
  Eigen::Matrix3d axes = grid.direction;
  const double handedness = axes.determinant() < 0 ? -1 : 1;
  axes.col(2) *= handedness;
  Eigen::Quaterniond rotation(axes);
  rotation.normalize();
  if (rotation.w() < 0) rotation.coeffs() *= -1;
  const std::array<double, 8> pixdim = {
      handedness, grid.spacing[0], grid.spacing[1], grid.spacing[2], 1, 1, 1, 1};
  for (std::size_t i = 0; i < 8; ++i) real(76 + 4 * i, 104 + 8 * i, pixdim[i]);
  real(112, 176, 1);  // slope
  const Vector bcd = one ? storedQuaternion(rotation) : Vector(rotation.vec());
  const std::array<double, 6> quaternion = {bcd[0],         bcd[1],         bcd[2],
                                            grid.origin[0], grid.origin[1], grid.origin[2]};
  for (std::size_t i = 0; i < 6; ++i) real(256 + 4 * i, 352 + 8 * i, quaternion[i]);
  const Eigen::Matrix4d affine = grid.affine();
  Eigen::Matrix4d qform = affine;
  qform.topLeftCorner<3, 3>() = rotationOf(bcd).toRotationMatrix() * grid.spacing.asDiagonal();
  qform.col(2) *= handedness;
  const bool qformHolds = disagreement(qform, affine, grid.size) < 0.5 * kAgreement;
  for (int i = 0; i < 12; ++i) real(280 + 4 * i, 400 + 8 * i, affine(i / 4, i % 4));

  constexpr int kMillimetres = 2;  // NIfTI's code of the unit
  constexpr int kScanner = 1;      // NIfTI's code of the frame
  // NIfTI's codes of what the values are.
  constexpr int kLabelIntent = 1002, kVectorIntent = 1007;
  const bool labels = volume.type != StoredType::Float32 && volume.type != StoredType::Float64;
  const int intent = vectors ? kVectorIntent : labels ? kLabelIntent : 0;
  constexpr std::size_t kNameLength = 15;  // bytes that NIfTI has for the name, and a zero
  std::memcpy(bytes.data() + (one ? 328 : 508), volume.name.data(),
              std::min(volume.name.size(), kNameLength));
  static constexpr char kDescription[] = "Explica";
  if (one) {
    bytes[123] = kMillimetres;
    put(68, static_cast<std::int16_t>(intent));
    put(108, static_cast<float>(bytes.size()));
    put(252, static_cast<std::int16_t>(qformHolds ? kScanner : 0));
    put(254, static_cast<std::int16_t>(kScanner));
    std::memcpy(bytes.data() + 148, kDescription, sizeof(kDescription));
  } else {
    put(500, static_cast<std::int32_t>(kMillimetres));
    put(504, static_cast<std::int32_t>(intent));
    put(168, static_cast<std::int64_t>(bytes.size()));
    put(344, static_cast<std::int32_t>(kScanner));
    put(348, static_cast<std::int32_t>(kScanner));
    std::memcpy(bytes.data() + 240, kDescription, sizeof(kDescription));
  }
  return bytes;
}

}  // namespace explica::io
