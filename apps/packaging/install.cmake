# What `cmake --install` installs of a library, and find_package(foucault COMPONENTS ...) finds.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(FOUCAULT_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/foucault)

# The package that find_package() knows a library by.
function(foucault_package_of LIBRARY RESULT)
  string(REGEX REPLACE "::.*" "" package ${LIBRARY})
  if(LIBRARY MATCHES "^mrpt::(.*)")
    set(package mrpt-${CMAKE_MATCH_1})
  elseif(LIBRARY MATCHES "^opencv_")
    set(package OpenCV)
  elseif(package STREQUAL "SQLite")
    set(package SQLite3)
  endif()
  set(${RESULT} ${package} PARENT_SCOPE)
endfunction()

# Library foucault_<name> as component <name>, with what it is linked to: components declared
# earlier, and packages. Each has a file of targets of its own.
function(foucault_install_component NAME)
  set(needs "")
  set(packages "")
  foreach(library ${ARGN})
    if(library MATCHES "^foucault::(.*)")
      get_property(needs_of_it GLOBAL PROPERTY foucault_${CMAKE_MATCH_1}_needs)
      list(APPEND needs ${needs_of_it} ${CMAKE_MATCH_1})
    elseif(TARGET ${library})
      foucault_package_of(${library} package)
      list(APPEND packages ${package})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES needs)
  list(REMOVE_DUPLICATES packages)
  set_property(GLOBAL PROPERTY foucault_${NAME}_needs ${needs})
  set_property(GLOBAL APPEND PROPERTY foucault_components ${NAME})
  set_property(GLOBAL APPEND_STRING PROPERTY foucault_table
               "set(_foucault_${NAME}_needs ${needs})\nset(_foucault_${NAME}_packages ${packages})\n")

  set_target_properties(foucault_${NAME} PROPERTIES EXPORT_NAME ${NAME})
  install(TARGETS foucault_${NAME} EXPORT foucault-${NAME}
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  install(EXPORT foucault-${NAME} NAMESPACE foucault:: DESTINATION ${FOUCAULT_CMAKE_DIR}
          COMPONENT development)
  if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/include)
    install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
  endif()
endfunction()

# After all components.
function(foucault_install_config)
  get_property(FOUCAULT_COMPONENTS GLOBAL PROPERTY foucault_components)
  get_property(FOUCAULT_TABLE GLOBAL PROPERTY foucault_table)
  configure_package_config_file(
    ${PROJECT_SOURCE_DIR}/apps/packaging/foucault-config.cmake.in foucault-config.cmake
    INSTALL_DESTINATION ${FOUCAULT_CMAKE_DIR} NO_SET_AND_CHECK_MACRO
    NO_CHECK_REQUIRED_COMPONENTS_MACRO)
  write_basic_package_version_file(foucault-config-version.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/foucault-config.cmake
                ${CMAKE_CURRENT_BINARY_DIR}/foucault-config-version.cmake
          DESTINATION ${FOUCAULT_CMAKE_DIR} COMPONENT development)
endfunction()
