# Builds the extension module `_chronormal` of python/, for the Python that setup.py names, or else for Debian's Python.
if(NOT CHRONORMAL_IO)
  message(FATAL_ERROR "CHRONORMAL_PYTHON needs CHRONORMAL_IO")
endif()
if(NOT Python_EXECUTABLE AND EXISTS /usr/bin/python3)
  set(Python_EXECUTABLE /usr/bin/python3)  # the first python3 on PATH may have no NumPy
endif()
find_package(Python QUIET COMPONENTS Interpreter Development.Module)
find_package(pybind11 2.10 QUIET CONFIG)
if(NOT Python_FOUND OR NOT pybind11_FOUND)
  set(severity FATAL_ERROR)
  if(CHRONORMAL_TESTS AND NOT CHRONORMAL_ALL_TESTS)
    set(severity STATUS)
  endif()
  message(${severity} "Python or pybind11 was not found (Debian: python3-dev, pybind11-dev): the extension module for Python is not built")
  return()
endif()

file(GLOB python_sources CONFIGURE_DEPENDS python/src/*.cpp)
pybind11_add_module(_chronormal NO_EXTRAS ${python_sources})
target_include_directories(_chronormal PRIVATE python/src src)  # src has the code that writes reports as JSON
target_compile_definitions(_chronormal PRIVATE CHRONORMAL_VERSION="${PROJECT_VERSION}")
target_link_libraries(_chronormal PRIVATE chronormal_io chronormal_product_flags)
target_link_options(_chronormal PRIVATE -Wl,--exclude-libs,ALL)

# The module and the files of python/chronormal form a package that can be imported from the build tree:
# PYTHONPATH=build/.../python.
set(python_package ${PROJECT_BINARY_DIR}/python/chronormal)
set_target_properties(_chronormal PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${python_package} CXX_STANDARD 20)
foreach(file __init__.py _chronormal.pyi py.typed)
  configure_file(${PROJECT_SOURCE_DIR}/python/chronormal/${file} ${python_package}/${file} COPYONLY)
endforeach()

# Adds the tests of the Python package, one for each file. The tests compare results of the package with results of the
# program and of the C library.
if(CHRONORMAL_TESTS)
  file(GLOB python_tests CONFIGURE_DEPENDS python/tests/test_*.py)
  foreach(file ${python_tests})
    cmake_path(GET file STEM name)
    string(REPLACE test_ python_ name ${name})
    add_test(NAME ${name} COMMAND ${Python_EXECUTABLE} ${file} WORKING_DIRECTORY ${PROJECT_BINARY_DIR})
    set_tests_properties(
      ${name} PROPERTIES TIMEOUT 300 LABELS python
                         ENVIRONMENT "PYTHONPATH=${PROJECT_BINARY_DIR}/python;PYTHONDONTWRITEBYTECODE=1;CHRONORMAL_BUILD=${PROJECT_BINARY_DIR};CHRONORMAL_PROGRAM=$<TARGET_FILE:chronormal_cli>;CHRONORMAL_C=$<TARGET_FILE:chronormal_c>")
  endforeach()
endif()
