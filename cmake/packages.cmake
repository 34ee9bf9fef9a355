# Every package that Kerf uses, found once. Heavy ones have one door each (docs/design.md).
list(PREPEND CMAKE_MODULE_PATH /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB)

find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(hwy 1.0 REQUIRED)
set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE ON)
set(CGAL_DATA_DIR "unused" CACHE PATH "")
if(KERF_CORE)
  set(CGAL_DISABLE_GMP ON)  # Boost.Multiprecision in its place
endif()
find_package(CGAL 5.5 REQUIRED)
find_package(nlohmann_json REQUIRED)
# Headers alone: one source compiles what others load as a library (io/toml_library.cpp, io/fingerprint.cpp).
find_path(KERF_TOML toml++/toml.h REQUIRED)
find_path(KERF_XXHASH xxhash.h REQUIRED)
if(KERF_FULL)
  find_package(TBB REQUIRED)
  find_package(PCL 1.13 REQUIRED COMPONENTS common kdtree)
  find_library(KERF_PCL_IO pcl_io REQUIRED)
  find_package(OpenVDB 10 QUIET REQUIRED)
  find_package(PkgConfig REQUIRED)
  pkg_check_modules(HDF5_SERIAL REQUIRED IMPORTED_TARGET hdf5-serial)
  find_package(assimp 5.2 REQUIRED)
  find_package(ZLIB REQUIRED)
endif()
if(KERF_TOOLS OR KERF_PYTHON)
  find_package(embree 3 REQUIRED)
  find_package(PNG REQUIRED)
endif()
if(KERF_TOOLS)
  find_package(CLI11 REQUIRED)
  find_path(KERF_BEAST boost/beast.hpp REQUIRED)  # headers only: libboost-dev
  pkg_check_modules(WEBP REQUIRED IMPORTED_TARGET libwebp libwebpmux)
  find_file(KERF_THREE_JS three.min.js PATHS /usr/share/javascript/three REQUIRED)
endif()
if(KERF_TESTS)
  find_package(Catch2 2.13 REQUIRED)
endif()

# Headers of libraries are not ours to warn about; PCL's flags (SSE, definitions) stay off our own files.
add_library(kerf_eigen INTERFACE)
target_link_libraries(kerf_eigen INTERFACE Eigen3::Eigen)

add_library(kerf_cgal INTERFACE)
target_link_libraries(kerf_cgal INTERFACE CGAL::CGAL)

# CGAL's headers, with Boost.Multiprecision in the place of GMP and MPFR.
add_library(kerf_cgal_core INTERFACE)
target_include_directories(kerf_cgal_core SYSTEM INTERFACE $<TARGET_PROPERTY:CGAL::CGAL,INTERFACE_INCLUDE_DIRECTORIES>)
target_compile_definitions(kerf_cgal_core INTERFACE CGAL_DISABLE_GMP=1)
target_compile_options(kerf_cgal_core INTERFACE $<$<CXX_COMPILER_ID:GNU>:-frounding-math>)

add_library(kerf_formats INTERFACE)
target_link_libraries(kerf_formats INTERFACE nlohmann_json::nlohmann_json)
target_include_directories(kerf_formats SYSTEM INTERFACE ${KERF_TOML} ${KERF_XXHASH})
target_compile_definitions(kerf_formats INTERFACE TOML_HEADER_ONLY=0)

if(KERF_FULL)
  # Headers alone: the library is opened when a file needs it, under the name that belongs to these headers.
  add_library(kerf_assimp INTERFACE)
  get_target_property(KERF_ASSIMP_INCLUDE assimp::assimp INTERFACE_INCLUDE_DIRECTORIES)
  get_target_property(KERF_ASSIMP_CONFIGURATION assimp::assimp IMPORTED_CONFIGURATIONS)
  get_target_property(KERF_ASSIMP_NAME assimp::assimp IMPORTED_SONAME_${KERF_ASSIMP_CONFIGURATION})
  target_include_directories(kerf_assimp SYSTEM INTERFACE ${KERF_ASSIMP_INCLUDE})
  target_compile_definitions(kerf_assimp INTERFACE KERF_ASSIMP="${KERF_ASSIMP_NAME}")

  add_library(kerf_beast INTERFACE)
  target_include_directories(kerf_beast SYSTEM INTERFACE ${KERF_BEAST})
  target_link_libraries(kerf_beast INTERFACE Threads::Threads)

  add_library(kerf_pcl INTERFACE)
  target_include_directories(kerf_pcl SYSTEM INTERFACE ${PCL_INCLUDE_DIRS})
  target_link_libraries(kerf_pcl INTERFACE ${PCL_COMMON_LIBRARIES} ${PCL_KDTREE_LIBRARIES} ${KERF_PCL_IO})
endif()
