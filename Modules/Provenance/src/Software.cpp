// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Provenance/Software.h"

#include <openssl/opensslv.h>
#include <sys/utsname.h>
#include <tbb/version.h>
#include <unistd.h>

#include <Eigen/Core>

#include <fstream>

// Written by CMake/WriteVersion.cmake into the build folder at each build.
namespace explica::provenance::build {
extern const char* const kVersion;
extern const char* const kCommit;
extern const bool kDirty;
extern const char* const kBuildType;
extern const char* const kCompiler;
}  // namespace explica::provenance::build

namespace explica::provenance {

const Software& software() {
  static const Software made{build::kVersion, build::kCommit, build::kDirty, build::kBuildType,
                             build::kCompiler};
  return made;
}

std::string softwareText() {
  const Software& s = software();
  return "explica " + s.version + " (commit " + s.commit.substr(0, 10) +
         (s.dirty ? ", with uncommitted changes)" : ")");
}

std::string builtWithText() {
  std::string libraries;
  const Json versions = describeLibraries();
  for (const auto& [name, version] : versions.items()) {
    libraries += (libraries.empty() ? "" : ", ") + name + " " + version.get<std::string>();
  }
  return "built by " + software().compiler + " (" + software().buildType + ") with " + libraries;
}

Json describeMachine(bool withNames) {
  Json machine = Json::object();
  utsname name{};
  if (uname(&name) == 0) {
    machine["os"] = std::string(name.sysname) + " " + name.release;
    machine["architecture"] = name.machine;
    if (withNames) machine["host"] = name.nodename;
  }
  if (withNames) {
    machine["user"] = static_cast<int>(getuid());
    if (const char* login = std::getenv("USER")) machine["user"] = login;
  }
  std::ifstream cpuInfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuInfo, line);) {
    if (line.starts_with("model name")) {
      machine["cpu"] = line.substr(line.find(':') + 2);
      break;
    }
  }
  machine["processors"] = static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN));
  machine["memory_bytes"] =
      static_cast<std::int64_t>(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGESIZE);
  for (const char* job : {"SLURM_JOB_ID", "PBS_JOBID", "JOB_ID"}) {
    if (const char* id = std::getenv(job)) machine["job"] = id;
  }
  return machine;
}

Json describeLibraries() {
  Json libraries = Json::object();
  libraries["Eigen"] = std::to_string(EIGEN_WORLD_VERSION) + "." +
                       std::to_string(EIGEN_MAJOR_VERSION) + "." +
                       std::to_string(EIGEN_MINOR_VERSION);
  libraries["OpenSSL"] = OPENSSL_VERSION_STR;
  libraries["nlohmann-json"] = std::to_string(NLOHMANN_JSON_VERSION_MAJOR) + "." +
                               std::to_string(NLOHMANN_JSON_VERSION_MINOR) + "." +
                               std::to_string(NLOHMANN_JSON_VERSION_PATCH);
  libraries["TBB"] = TBB_VERSION_STRING;
  libraries["ITK"] = EXPLICA_ITK_VERSION;
  const std::string vtk = EXPLICA_VTK_VERSION;  // empty without a window
  if (!vtk.empty()) libraries["VTK"] = vtk;
  libraries["Embree"] = EXPLICA_EMBREE_VERSION;
  return libraries;
}

}  // namespace explica::provenance
