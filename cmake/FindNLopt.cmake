# NLopt with its C++ algorithms (StoGO, AGS): Debian splits them off into libnlopt_cxx and ships two
# NLoptConfig.cmake side by side, of which find_package would take whichever it meets first.
find_path(NLopt_INCLUDE_DIR nlopt.hpp)
find_library(NLopt_LIBRARY NAMES nlopt_cxx nlopt)
mark_as_advanced(NLopt_INCLUDE_DIR NLopt_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(NLopt REQUIRED_VARS NLopt_LIBRARY NLopt_INCLUDE_DIR)

if(NLopt_FOUND AND NOT TARGET NLopt::nlopt)
  add_library(NLopt::nlopt UNKNOWN IMPORTED)
  set_target_properties(NLopt::nlopt PROPERTIES
    IMPORTED_LOCATION ${NLopt_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${NLopt_INCLUDE_DIR})
endif()
