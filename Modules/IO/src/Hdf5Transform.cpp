// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Hdf5Transform.h"

#include "Explica/Core/Errors.h"

#include <hdf5.h>

namespace explica::io {
namespace {

constexpr unsigned kDeflateLevel = 5;  // as ITK's writer; higher levels gain a per cent

/// An open object of HDF5's library, closed with its scope.
class Handle {
 public:
  Handle(const std::filesystem::path& path, hid_t id, herr_t (*close)(hid_t))
      : id_(id), close_(close) {
    if (id < 0) throw EnvironmentError(path.string() + ": cannot be written");
  }
  ~Handle() { close_(id_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void check(const std::filesystem::path& path, herr_t status) {
  if (status < 0) throw EnvironmentError(path.string() + ": cannot be written");
}

/// A list of properties whose objects note no times.
Handle timeless(const std::filesystem::path& path, hid_t kind) {
  const hid_t list = H5Pcreate(kind);
  if (list >= 0) H5Pset_obj_track_times(list, 0);
  return {path, list, H5Pclose};
}

void writeGroup(const std::filesystem::path& path, hid_t file, const std::string& name) {
  const Handle properties = timeless(path, H5P_GROUP_CREATE);
  const Handle group(path, H5Gcreate2(file, name.c_str(), H5P_DEFAULT, properties, H5P_DEFAULT),
                     H5Gclose);
}

void writeText(const std::filesystem::path& path, hid_t file, const std::string& name,
               const std::string& text) {
  const Handle type(path, H5Tcopy(H5T_C_S1), H5Tclose);
  check(path, H5Tset_size(type, H5T_VARIABLE));  // ITK reads no other
  const hsize_t one = 1;
  const Handle space(path, H5Screate_simple(1, &one, nullptr), H5Sclose);
  const Handle properties = timeless(path, H5P_DATASET_CREATE);
  const Handle data(
      path, H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT),
      H5Dclose);
  const char* const begin = text.c_str();
  check(path, H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &begin));
}

void writeNumbers(const std::filesystem::path& path, hid_t file, const std::string& name,
                  const std::vector<double>& numbers) {
  const hsize_t count = numbers.size();
  const Handle space(path, H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Handle properties = timeless(path, H5P_DATASET_CREATE);
  if (count > 0) {
    check(path, H5Pset_chunk(properties, 1, &count));
    check(path, H5Pset_deflate(properties, kDeflateLevel));
  }
  const Handle data(
      path,
      H5Dcreate2(file, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT),
      H5Dclose);
  if (count > 0) {
    check(path, H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()));
  }
}

}  // namespace

void writeHdf5Transform(const std::filesystem::path& path,
                        const std::vector<TransformEntry>& transforms) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // faults are thrown here, not printed there
  const Handle properties = timeless(path, H5P_FILE_CREATE);
  const Handle file(path, H5Fcreate(path.c_str(), H5F_ACC_TRUNC, properties, H5P_DEFAULT),
                    H5Fclose);
  writeText(path, file, "/ITKVersion", "5.2");
  writeGroup(path, file, "/TransformGroup");
  for (std::size_t n = 0; n < transforms.size(); ++n) {
    const std::string group = "/TransformGroup/" + std::to_string(n);
    writeGroup(path, file, group);
    writeText(path, file, group + "/TransformType", transforms[n].type);
    if (transforms[n].type.starts_with("CompositeTransform")) continue;
    writeNumbers(path, file, group + "/TransformFixedParameters", transforms[n].fixed);
    writeNumbers(path, file, group + "/TransformParameters", transforms[n].parameters);
  }
  check(path, H5Fflush(file, H5F_SCOPE_GLOBAL));
}

}  // namespace explica::io
