# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Debian packages by `cpack --config build/CPackConfig.cmake`: explica (program, pages, completion, schedulers' scripts),
# explica-window (what `explica view` starts), python3-explica, and libexplica-dev (headers, static libraries, CMake files).
# Testing/check-package.sh makes, unpacks and runs them.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME explica)
set(CPACK_PACKAGE_VENDOR "The Explica developers")
set(CPACK_PACKAGE_CONTACT "The Explica developers <explica@explica.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_BINARY_DIR}/packages")
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development)
if(TARGET explica-window)
  list(APPEND CPACK_COMPONENTS_ALL window)
endif()
if(TARGET _explica)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME explica)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "explica-window, mricron-data")
set(CPACK_DEBIAN_WINDOW_PACKAGE_NAME explica-window)
set(CPACK_DEBIAN_WINDOW_PACKAGE_DEPENDS "explica (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libexplica-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
# What a consumer's find_package(Explica) looks for (FIND of the modules).
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libeigen3-dev, libboost-dev, libtbb-dev, libhwy-dev, libinsighttoolkit5-dev, \
libisal-dev, libexpat1-dev, nlohmann-json3-dev, libssl-dev, libyaml-cpp-dev, libembree-dev, libpng-dev, zlib1g-dev")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-explica)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
# A compiled module fits one version of Python.
execute_process(COMMAND /usr/bin/python3 -c
  "import sys; v = sys.version_info; print(f'python3 (>= {v[0]}.{v[1]}), python3 (<< {v[0]}.{v[1] + 1})', end='')"
  OUTPUT_VARIABLE python_versions)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "${python_versions}, python3-numpy")
include(CPack)
