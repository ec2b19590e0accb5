# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Text files that a library carries in itself, so that it needs none beside it.

# explica_pack_texts(<variable> <header> <namespace> <name>=<file>...)
# Sets <variable> to a source that defines `const char* const <name>` in the namespace for each file; the
# header, which the source includes, declares them.
function(explica_pack_texts variable header namespace)
  set(source "${CMAKE_CURRENT_BINARY_DIR}/PackedTexts.cpp")
  set(text "#include \"${header}\"\nnamespace ${namespace} {\n")
  foreach(entry IN LISTS ARGN)
    string(FIND "${entry}" "=" at)
    string(SUBSTRING "${entry}" 0 ${at} name)
    math(EXPR at "${at} + 1")
    string(SUBSTRING "${entry}" ${at} -1 path)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${path}")
    file(READ "${path}" content)
    string(APPEND text "const char* const ${name} = R\"explica~(${content})explica~\";\n")
  endforeach()
  string(APPEND text "}\n")
  file(GENERATE OUTPUT "${source}" CONTENT "${text}")
  set(${variable} "${source}" PARENT_SCOPE)
endfunction()
