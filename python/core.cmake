# The target kerf_python_core and the component python_core: the module of the core, for wheels (python/build). Its
# extension has the objects of _kerf, which call the public API alone. Highway's library, in Debian a shared one only,
# goes beside it. core/*.py stand for the extensions that are missing.
set(core_package ${CMAKE_CURRENT_BINARY_DIR}/core/kerf)
set(core_target _kerf)
if(NOT KERF_CORE)
  set(core_target _kerf_core)
  add_library(_kerf_core MODULE EXCLUDE_FROM_ALL $<TARGET_OBJECTS:_kerf>)
  target_link_libraries(_kerf_core PRIVATE geo_core kerf_flags)
  target_link_options(_kerf_core PRIVATE -Wl,--exclude-libs,ALL -Wl,--gc-sections)
  get_target_property(suffix _kerf SUFFIX)
  set_target_properties(_kerf_core PROPERTIES OUTPUT_NAME _kerf PREFIX "" SUFFIX ${suffix} LINKER_LANGUAGE CXX)
endif()
set_target_properties(${core_target} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${core_package} BUILD_RPATH "$ORIGIN"
  INSTALL_RPATH "$ORIGIN" BUILD_WITH_INSTALL_RPATH ON)

file(GLOB core_files CONFIGURE_DEPENDS core/*.py)
add_custom_target(kerf_python_core DEPENDS ${core_target}
  COMMAND ${CMAKE_COMMAND} -E copy_if_different ${python_files} ${core_files} ${core_package})
if(KERF_TESTS)
  set_target_properties(kerf_python_core ${core_target} PROPERTIES EXCLUDE_FROM_ALL OFF)
endif()
install(TARGETS ${core_target} LIBRARY DESTINATION kerf COMPONENT python_core EXCLUDE_FROM_ALL)
install(FILES ${python_files} ${core_files} DESTINATION kerf COMPONENT python_core EXCLUDE_FROM_ALL)

get_target_property(hwy_configurations hwy::hwy IMPORTED_CONFIGURATIONS)
list(GET hwy_configurations 0 hwy_configuration)
get_target_property(hwy_library hwy::hwy IMPORTED_LOCATION_${hwy_configuration})
get_target_property(hwy_name hwy::hwy IMPORTED_SONAME_${hwy_configuration})
if(hwy_name)  # a static library is in the extension
  add_custom_command(TARGET kerf_python_core POST_BUILD
    COMMAND ${CMAKE_COMMAND} -E copy_if_different ${hwy_library} ${core_package}/${hwy_name})
  find_file(KERF_HWY_LICENCE copyright PATHS /usr/share/doc/libhwy1 /usr/share/doc/libhwy-dev)
  install(PROGRAMS ${hwy_library} DESTINATION kerf COMPONENT python_core EXCLUDE_FROM_ALL RENAME ${hwy_name})
  install(FILES ${KERF_HWY_LICENCE} DESTINATION kerf COMPONENT python_core EXCLUDE_FROM_ALL RENAME libhwy-licence.txt OPTIONAL)
endif()
