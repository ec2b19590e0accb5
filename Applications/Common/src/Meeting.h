// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Declaration.h"
#include "Explica/Provenance/Record.h"

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace explica::app {

/// Names by which a user goes on although files do not belong together.
inline constexpr const char* kAcceptHemisphere = "hemisphere";
inline constexpr const char* kAcceptMesh = "mesh";

/// Whether a command's own files can fail to belong together: it reads surfaces or vertex data, and
/// not as a mere frame around other commands.
[[nodiscard]] bool filesMeet(const Declaration& declaration);

/// The files of one run, compared as they come in.
///
/// Left is left: the hemisphere that a surface or a file of vertex data states must be that of the
/// others, of --hemisphere and of the option's own side (--left).  Vertex data must be of the
/// surface's mesh: where records tell which surfaces either was made with or beside, they must
/// share one.  Files of the role "person", of one of many people, are compared with no other: the
/// command knows of which side each should be.
class Meeting {
 public:
  /// @param given     options that the user set
  /// @param accepted  contradictions to go on with
  /// @throws UsageError  one of them is no contradiction, and the command has no limits of its own
  Meeting(const Declaration& declaration, const std::set<std::string>& given,
          std::vector<std::string> accepted);

  /// @param role   the option that names the file, or what a command found it for
  /// @param found  the record that lists the file
  /// @return a sentence for each contradiction that is accepted
  /// @throws InvalidInput  one that is not accepted: names both files
  std::vector<std::string> add(const std::string& role, const std::filesystem::path& file,
                               const std::string& sha256,
                               const std::optional<provenance::FoundRecord>& found);

 private:
  struct File {
    std::string role, name;  ///< the name as in sentences
    std::optional<Hemisphere> side;
    const Parameter* parameter = nullptr;
    std::set<std::string> surfaces;  ///< hashes of surfaces of the same mesh, as records tell
  };

  [[nodiscard]] static std::string sidesOf(const File& one, const File& other);
  [[nodiscard]] static std::string meshesOf(const File& one, const File& other);
  /// True if an option's files, each of which stands for itself, are of both sides: they do not
  /// tell of which the others should be.
  [[nodiscard]] bool hasBothSides(const std::string& role) const;
  void contradict(const char* name, const std::string& sentence,
                  std::vector<std::string>& sentences) const;

  const Declaration& declaration_;
  std::vector<std::string> accepted_;
  std::vector<File> files_;
};

}  // namespace explica::app
