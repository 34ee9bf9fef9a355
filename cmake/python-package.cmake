# The Debian package python3-kerf. Its extensions are for one minor version of Python, which dpkg has to know; its byte code
# is made at installation and removed with it, as packages of Debian do.
execute_process(COMMAND ${KERF_PYTHON_EXECUTABLE} -c "import sys; print('%d.%d' % sys.version_info[:2], '%d.%d' % (sys.version_info[0], sys.version_info[1] + 1))"
  OUTPUT_VARIABLE versions OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
separate_arguments(versions UNIX_COMMAND "${versions}")
list(GET versions 0 python)
list(GET versions 1 python_after)
foreach(script postinst prerm)
  configure_file(cmake/python-${script} ${PROJECT_BINARY_DIR}/python-package/${script} COPYONLY FILE_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
  list(APPEND scripts ${PROJECT_BINARY_DIR}/python-package/${script})
endforeach()
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-kerf)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= ${python}), python3 (<< ${python_after}), python3-numpy, ${KERF_ASSIMP_PACKAGE}")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${scripts})
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "split deforming solids along any crack (Python module)\nThe module kerf: meshes, cracks, pieces, bodies and simulations with NumPy arrays in and out.")
