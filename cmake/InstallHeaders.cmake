# Part of `cmake --install`: copies the headers with their includes rewritten. Takes repose_source,
# repose_headers, repose_version_header and repose_include. Writes only what has changed.
set(repose_root "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/${repose_include}")

function(repose_install_header from to)
  file(READ "${from}" text)
  string(REGEX REPLACE "#include \"(calibration|io|models|mpm|pointdriver)/"
                       "#include \"repose/\\1/" text "${text}")
  set(file "${repose_root}/${to}")
  list(APPEND CMAKE_INSTALL_MANIFEST_FILES "${CMAKE_INSTALL_PREFIX}/${repose_include}/${to}")
  set(CMAKE_INSTALL_MANIFEST_FILES "${CMAKE_INSTALL_MANIFEST_FILES}" PARENT_SCOPE)
  if(EXISTS "${file}")
    file(READ "${file}" before)
    if(before STREQUAL text)
      return()
    endif()
  endif()
  message(STATUS "Installing: ${file}")
  file(WRITE "${file}" "${text}")
endfunction()

foreach(header IN LISTS repose_headers)
  repose_install_header("${repose_source}/${header}" "${header}")
endforeach()
repose_install_header("${repose_version_header}" version.hpp)
