// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Hdf5Transform.h"

#include "ConfinedProcess.h"

#include <hdf5.h>

#include <stdexcept>

namespace explica::io {
namespace {

constexpr unsigned kDeflateLevel = 5;           // as ITK's writer; higher levels gain a per cent
constexpr std::size_t kMostUnpacking = 1032;    // deflate packs no better
constexpr std::size_t kLibrary = 64ULL << 20U;  // bytes that HDF5 takes for any file
constexpr std::size_t kMostInName = 1000;       // characters of a transform's type
const std::string kGroup = "/TransformGroup";

[[noreturn]] void fail() {
  throw std::runtime_error("HDF5 refuses");
}

herr_t checked(herr_t status) {
  if (status < 0) fail();
  return status;
}

/// An open object of HDF5's library, closed with its scope.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {
    if (id < 0) fail();
  }
  ~Handle() { close_(id_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

// ---- what is written ----------------------------------------------------------------------------

/// A list of properties whose objects note no times.
Handle timeless(hid_t kind) {
  const hid_t list = H5Pcreate(kind);
  if (list >= 0) H5Pset_obj_track_times(list, 0);
  return {list, H5Pclose};
}

void writeGroup(hid_t file, const std::string& name) {
  const Handle properties = timeless(H5P_GROUP_CREATE);
  const Handle group(H5Gcreate2(file, name.c_str(), H5P_DEFAULT, properties, H5P_DEFAULT),
                     H5Gclose);
}

void writeText(hid_t file, const std::string& name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  checked(H5Tset_size(type, H5T_VARIABLE));  // ITK reads no other
  const hsize_t one = 1;
  const Handle space(H5Screate_simple(1, &one, nullptr), H5Sclose);
  const Handle properties = timeless(H5P_DATASET_CREATE);
  const Handle data(
      H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose);
  const char* const begin = text.c_str();
  checked(H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &begin));
}

void writeNumbers(hid_t file, const std::string& name, const std::vector<double>& numbers) {
  const hsize_t count = numbers.size();
  const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Handle properties = timeless(H5P_DATASET_CREATE);
  if (count > 0) {
    checked(H5Pset_chunk(properties, 1, &count));
    checked(H5Pset_deflate(properties, kDeflateLevel));
  }
  const Handle data(
      H5Dcreate2(file, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT),
      H5Dclose);
  if (count > 0) {
    checked(H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()));
  }
}

// ---- what is read -------------------------------------------------------------------------------

/// The file as it stands in memory: nothing is locked, as on servers it may not be.
Handle openInMemory(ByteView bytes) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  checked(H5Pset_fapl_core(access, bytes.size(), 0));
  checked(H5Pset_file_image(access, const_cast<std::uint8_t*>(bytes.data()), bytes.size()));
  return {H5Fopen("transform", H5F_ACC_RDONLY, access), H5Fclose};
}

std::string readText(hid_t file, const std::string& name) {
  const Handle data(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  const Handle type(H5Dget_type(data), H5Tclose);
  const Handle space(H5Dget_space(data), H5Sclose);
  if (H5Tget_class(type) != H5T_STRING || H5Sget_simple_extent_npoints(space) != 1) fail();
  if (checked(H5Tis_variable_str(type)) > 0) {
    const char* text = nullptr;
    checked(H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &text));
    return text == nullptr ? "" : text;
  }
  std::string text(H5Tget_size(type), '\0');
  checked(H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()));
  return text.c_str();
}

/// Numbers of any type; older versions of ITK misspelt their names.
std::vector<double> readNumbers(hid_t file, const std::string& group, const std::string& name,
                                std::size_t most) {
  const std::string proper = group + "/Transform" + name, misspelt = group + "/Tranform" + name;
  const bool there = checked(H5Lexists(file, proper.c_str(), H5P_DEFAULT)) > 0;
  const Handle data(H5Dopen2(file, (there ? proper : misspelt).c_str(), H5P_DEFAULT), H5Dclose);
  const Handle space(H5Dget_space(data), H5Sclose);
  const auto count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
  if (count > most) fail();
  std::vector<double> numbers(count);
  if (count > 0) {
    checked(H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()));
  }
  return numbers;
}

/// Sends the count of transforms; of each its type, parameters and fixed parameters, counts first.
void sendEntries(ByteView bytes, std::size_t most, const ConfinedProcess::Send& send) {
  const auto sendAll = [&](const auto& values) {
    const std::size_t count = values.size();
    send(&count, sizeof count);
    send(values.data(), count * sizeof values[0]);
  };
  const Handle file = openInMemory(bytes);
  H5G_info_t group{};
  checked(H5Gget_info_by_name(file, kGroup.c_str(), &group, H5P_DEFAULT));
  const std::size_t transforms = group.nlinks;
  if (transforms > kMostTransforms) fail();
  send(&transforms, sizeof transforms);
  for (std::size_t n = 0; n < transforms; ++n) {
    const std::string place = kGroup + "/" + std::to_string(n);
    const std::string type = readText(file, place + "/TransformType");
    const bool whole = !type.starts_with("CompositeTransform");
    sendAll(type);
    for (const char* name : {"Parameters", "FixedParameters"}) {
      sendAll(whole ? readNumbers(file, place, name, most) : std::vector<double>{});
    }
  }
}

}  // namespace

bool looksLikeHdf5(ByteView bytes) {
  return textOf(bytes).starts_with(std::string_view("\x89HDF\r\n\x1a\n", 8));
}

std::vector<TransformEntry> readHdf5Transform(const std::filesystem::path& path, ByteView bytes) {
  const std::size_t most = kMostUnpacking * bytes.size() / sizeof(float);  // values
  H5open();  // once, not in every process
  const ConfinedProcess reader(kLibrary + 4 * most * sizeof(double), [&](const auto& send) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    sendEntries(bytes, most, send);
  });
  const auto receive = [&](void* to, std::size_t count) {
    if (reader.receive(to, count)) return;
    failToRead(
        path,
        "is damaged, or is HDF5 of another kind than ITK's transforms: copy or make it again");
  };
  const auto receiveAll = [&](auto& values, std::size_t mostValues) {
    std::size_t count = 0;
    receive(&count, sizeof count);
    if (count > mostValues) failToRead(path, "is damaged: an array has no proper size");
    values.resize(count);
    receive(values.data(), count * sizeof values[0]);
  };
  std::size_t transforms = 0;
  receive(&transforms, sizeof transforms);
  std::vector<TransformEntry> entries;
  for (std::size_t n = 0; n < transforms; ++n) {
    TransformEntry entry;
    receiveAll(entry.type, kMostInName);
    receiveAll(entry.parameters, most);
    receiveAll(entry.fixed, most);
    entries.push_back(std::move(entry));
  }
  return entries;
}

void writeHdf5Transform(const std::filesystem::path& path,
                        const std::vector<TransformEntry>& transforms) try {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // faults are thrown here, not printed there
  const Handle properties = timeless(H5P_FILE_CREATE);
  const Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, properties, H5P_DEFAULT), H5Fclose);
  writeText(file, "/ITKVersion", "5.2");
  writeGroup(file, kGroup);
  for (std::size_t n = 0; n < transforms.size(); ++n) {
    const std::string group = kGroup + "/" + std::to_string(n);
    writeGroup(file, group);
    writeText(file, group + "/TransformType", transforms[n].type);
    if (transforms[n].type.starts_with("CompositeTransform")) continue;
    writeNumbers(file, group + "/TransformFixedParameters", transforms[n].fixed);
    writeNumbers(file, group + "/TransformParameters", transforms[n].parameters);
  }
  checked(H5Fflush(file, H5F_SCOPE_GLOBAL));
} catch (const std::runtime_error&) {
  throw EnvironmentError(path.string() + ": cannot be written");
}

}  // namespace explica::io
