# Headers that nearly every source reads, compiled once instead of once per source.
# KERF_PRECOMPILED=OFF compiles each source alone, as a program that links kerf::geo does.
option(KERF_PRECOMPILED "Precompile Eigen and the standard headers that most sources include" ON)
set(KERF_PRECOMPILED_HEADERS <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <cmath> <cstdint> <functional> <map> <memory>
  <optional> <ostream> <set> <span> <string> <unordered_map> <utility> <vector>)

# kerf_precompile(TARGET [HEADER...]): the common headers, and more of the target's own.
function(kerf_precompile target)
  if(KERF_PRECOMPILED)
    target_precompile_headers(${target} PRIVATE ${KERF_PRECOMPILED_HEADERS} ${ARGN})
  endif()
endfunction()

# kerf_precompiled_by(TARGET OTHER): the headers that were compiled for OTHER, which has the same options.
function(kerf_precompiled_by target other)
  if(KERF_PRECOMPILED)
    target_precompile_headers(${target} REUSE_FROM ${other})
  endif()
endfunction()

# KERF_UNITY=ON compiles six sources of a target as one: templates are instantiated once for all of them. It saves a
# third of a first build; a later build compiles more after a change, so that developers leave it off.
option(KERF_UNITY "Compile several sources as one; for a first build" OFF)

# kerf_unity(TARGET SOURCE...): for all sources but those that are compiled once per instruction set, and those that
# need OpenVDB, HDF5 or assimp: programs that do not call them must not load these.
function(kerf_unity target)
  if(KERF_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 6)
    foreach(source IN LISTS ARGN)
      file(STRINGS ${source} alone REGEX "foreach_target.h|<openvdb/|<hdf5.h>|<assimp/" LIMIT_COUNT 1)
      if(alone)
        set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
      endif()
    endforeach()
  endif()
endfunction()
