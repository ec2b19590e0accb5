# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Run at each build (cmake -P): writes OUTPUT only if the version, commit or dirty flag changed.
set(commit "unknown")
set(dirty "false")
find_program(GIT git)
if(GIT)
  # The sources may belong to another user than the one who builds, as in a container.
  set(git ${GIT} -c safe.directory=* -C "${SOURCE_DIR}")
  execute_process(COMMAND ${git} rev-parse HEAD
    OUTPUT_VARIABLE head RESULT_VARIABLE status OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(status EQUAL 0)
    set(commit "${head}")
    execute_process(COMMAND ${git} status --porcelain --untracked-files=no
      OUTPUT_VARIABLE changes OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(changes)
      set(dirty "true")
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT "${OUTPUT}" @ONLY CONTENT [[
namespace explica::provenance::build {
extern const char* const kVersion;
extern const char* const kCommit;
extern const bool kDirty;
extern const char* const kBuildType;
extern const char* const kCompiler;
const char* const kVersion = "@VERSION@";
const char* const kCommit = "@commit@";
const bool kDirty = @dirty@;
const char* const kBuildType = "@BUILD_TYPE@";
const char* const kCompiler = "@COMPILER@";
}  // namespace explica::provenance::build
]])
