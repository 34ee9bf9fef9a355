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
