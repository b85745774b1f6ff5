# repose_precompile(target kernels|room|test): what most files of such a target include from
# elsewhere, parsed once for all of them. (One header for all would do if a precompiled one did not
# bring its own optimisation along.) A file still includes what it uses, and compiles without these:
# CMAKE_DISABLE_PRECOMPILE_HEADERS=ON, for compiler caches that cannot look into them.
set(repose_library_headers <algorithm> <array> <cmath> <filesystem> <functional> <map> <memory>
    <optional> <span> <string> <vector> <xsimd/xsimd.hpp>)
set(repose_kernels_headers ${repose_library_headers} <fmt/core.h> <tbb/parallel_for.h> <tbb/task_arena.h>)
set(repose_room_headers ${repose_library_headers} <set> <fmt/format.h> <toml++/toml.h> <Eigen/Core>)
set(repose_test_headers ${repose_library_headers} <fstream> <random> <sstream> <gtest/gtest.h>)

function(repose_precompile target kind)
  get_property(owner GLOBAL PROPERTY repose_precompiled_${kind})
  if(owner)
    target_precompile_headers(${target} REUSE_FROM ${owner})
  else()
    target_precompile_headers(${target} PRIVATE ${repose_${kind}_headers})
    target_link_libraries(${target} PRIVATE repose_simd Eigen3::Eigen) # where the headers are
    set_property(GLOBAL PROPERTY repose_precompiled_${kind} ${target})
  endif()
endfunction()
