# `cmake --build build --target doc`: build/doc/html/index.html, of the public headers and the pages
# of the modules, where Doxygen is found.
find_package(Doxygen QUIET)
if(NOT DOXYGEN_FOUND)
  return()
endif()
set(DOXYGEN_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/doc)
set(DOXYGEN_USE_MDFILE_AS_MAINPAGE ${PROJECT_SOURCE_DIR}/README.md)
set(DOXYGEN_FULL_PATH_NAMES YES)
set(DOXYGEN_STRIP_FROM_PATH ${PROJECT_SOURCE_DIR})
set(DOXYGEN_EXTRACT_ALL YES)
set(DOXYGEN_EXCLUDE_PATTERNS */tests/* */src/* */build*/*)
set(DOXYGEN_IMAGE_PATH ${PROJECT_SOURCE_DIR})
set(DOXYGEN_JAVADOC_AUTOBRIEF YES)
set(DOXYGEN_BUILTIN_STL_SUPPORT YES)
set(DOXYGEN_HAVE_DOT NO)
set(DOXYGEN_QUIET YES)
set(DOXYGEN_WARN_AS_ERROR FAIL_ON_WARNINGS)
doxygen_add_docs(doc README.md CHANGELOG.md modules rawlog gui-free-reports apps/README.md
                 apps/examples apps/cluster
                 COMMENT "Pages of the public headers: doc/html/index.html")
if(FOUCAULT_TESTS)
  add_test(NAME doc COMMAND Doxygen::doxygen ${CMAKE_BINARY_DIR}/Doxyfile.doc
           WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(doc PROPERTIES TIMEOUT 300)
endif()
