# `cpack -G DEB` in the build folder: one Debian package with the program, the libraries, what links
# them, and the licence. Configure it with -DREPOSE_NATIVE=OFF, or it runs on this machine's kind only, and
# with -DREPOSE_MORE_SETS=x86-64-v4, or machines with AVX-512 do not use it.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME repose)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_VENDOR "The repose authors")
set(CPACK_PACKAGE_CONTACT "The repose authors <repose@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# Which packages hold the shared libraries that these link, by dpkg-shlibdeps (package dpkg-dev).
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/lib)
# Pictures; and what a law of one's own is compiled with.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "gnuplot-nox")
if(GDAL_FOUND)  # loaded where a map needs it
  string(REGEX REPLACE "^lib(.*)[.]so[.](.*)$" "lib\\1\\2" repose_gdal_package ${repose_gdal_library})
  string(APPEND CPACK_DEBIAN_PACKAGE_RECOMMENDS ", ${repose_gdal_package}")
endif()
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "g++, cmake, libeigen3-dev, libxsimd-dev, libceres-dev")
include(CPack)
