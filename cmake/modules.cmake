# A module of libgeo is an object library of all sources below its folder. kerf::geo joins all modules in one static
# library, so that a tool links and starts only what it uses.
add_library(kerf_flags INTERFACE)
target_compile_options(kerf_flags INTERFACE -Wall -Wextra $<$<CONFIG:Debug>:-O1>)
# Exact predicates rely on IEEE arithmetic: no contraction into fused operations, no fast-math.
target_compile_options(kerf_flags INTERFACE -ffp-contract=off)
# gcc 12 warns of impossible overlaps inside std::string at -O3 (its bug 105329).
target_compile_options(kerf_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
target_link_options(kerf_flags INTERFACE $<$<NOT:$<PLATFORM_ID:Emscripten>>:-Wl,--as-needed>)
# gcc 12 also warns of impossible lengths and bounds inside std::string (its bug 105651), and of types of anonymous
# namespaces where sources are compiled as one. Targets that join many strings have these warnings off.
function(kerf_quiet target)
  target_compile_options(${target} PRIVATE
    $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow -Wno-stringop-overread -Wno-array-bounds -Wno-subobject-linkage>)
endfunction()
if(KERF_WERROR)
  target_compile_options(kerf_flags INTERFACE -Werror)
endif()
if(KERF_SANITIZE)
  target_compile_options(kerf_flags INTERFACE -fsanitize=${KERF_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(kerf_flags INTERFACE -fsanitize=${KERF_SANITIZE})
endif()
if(KERF_FUZZ)
  target_compile_options(kerf_flags INTERFACE -fsanitize=fuzzer-no-link,address,undefined -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(kerf_flags INTERFACE -fsanitize=address,undefined)
endif()

# Modules and inner modules in their order: each includes only those before it. The test `architecture` has the order
# from here. KERF_MODULES are the folders of libgeo alone.
set(KERF_MODULE_ORDER base geometry surface sampling graph crack score body
  mechanics/material mechanics/terms mechanics/discretisation mechanics/solver
  contact/detection contact/surface contact/response contact/motion contact/embedding contact
  simulation io jobs)
string(REGEX REPLACE "/[^;]*" "" KERF_MODULES "${KERF_MODULE_ORDER}")
list(REMOVE_DUPLICATES KERF_MODULES)

# kerf_part(EDITION NAME SOURCES path... [LIBRARIES target...] [DEFINITIONS word...]): sources that differ between the
# editions of the library: FULL, and CORE, which does without most other libraries (docs/core.md). Called before
# kerf_module(), which leaves these sources out. A core build has no targets of the full edition.
set(KERF_PART_SOURCES)
set(KERF_PARTS_FULL)
set(KERF_PARTS_CORE)
function(kerf_part edition name)
  cmake_parse_arguments(part "" "" "SOURCES;LIBRARIES;DEFINITIONS" ${ARGN})
  list(TRANSFORM part_SOURCES PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  set(KERF_PART_SOURCES ${KERF_PART_SOURCES} ${part_SOURCES} PARENT_SCOPE)
  if(KERF_CORE AND edition STREQUAL "FULL")
    return()
  endif()
  set(target geo_part_${name})
  add_library(${target} OBJECT ${part_SOURCES})
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/include)
  target_link_libraries(${target} PRIVATE kerf_flags kerf_eigen ${part_LIBRARIES})
  target_compile_definitions(${target} PRIVATE ${part_DEFINITIONS})
  kerf_quiet(${target})
  set_property(TARGET ${target} PROPERTY POSITION_INDEPENDENT_CODE ON)
  set(KERF_PARTS_${edition} ${KERF_PARTS_${edition}} ${target} PARENT_SCOPE)
endfunction()

function(kerf_module module)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${module}/*.cpp)
  list(REMOVE_ITEM sources ${KERF_PART_SOURCES})
  if(NOT sources)
    return()
  endif()
  add_library(geo_${module} OBJECT ${sources})
  kerf_unity(geo_${module} ${sources})
  target_include_directories(geo_${module} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}> $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>)
  target_link_libraries(geo_${module} PRIVATE kerf_flags PUBLIC kerf_eigen ${ARGN})
  if(module STREQUAL "base")
    kerf_precompile(geo_${module})
  elseif(module STREQUAL "io")
    kerf_precompile(geo_io <nlohmann/json.hpp>)
  else()
    kerf_precompiled_by(geo_${module} geo_base)
  endif()
  if(module STREQUAL "io" OR module STREQUAL "crack")
    kerf_quiet(geo_${module})
  endif()
  set_property(TARGET geo_${module} PROPERTY POSITION_INDEPENDENT_CODE ON)
endfunction()
