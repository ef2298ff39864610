# What is installed, and find_package(dubsar).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# The loader looks for plugins in lib/dubsar/drivers beside the folder of the program, on every system.
set(DUBSAR_INSTALL_DRIVERS lib/dubsar/drivers)
set(DUBSAR_INSTALL_CONFIG ${CMAKE_INSTALL_LIBDIR}/cmake/dubsar)

# dubsar_install_library(NAME LINKS NEEDS): archive, headers, and a file of the component with its target dubsar::NAME.
function(dubsar_install_library name links needs)
  set_target_properties(dubsar_${name} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS dubsar_${name} EXPORT dubsar_${name}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  install(EXPORT dubsar_${name} NAMESPACE dubsar:: FILE dubsar_${name}_target.cmake
    DESTINATION ${DUBSAR_INSTALL_CONFIG} COMPONENT development)
  file(GLOB headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.h)
  install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/dubsar/${name} COMPONENT development)

  set(text "# Component ${name} of dubsar.\n")
  foreach(link ${links})
    if(link MATCHES "^dubsar_(.*)$")
      string(APPEND text "dubsar_component(${CMAKE_MATCH_1})\n")
    endif()
  endforeach()
  foreach(need ${needs})
    string(APPEND text "${need}\n")
  endforeach()
  string(APPEND text "include(\"\${CMAKE_CURRENT_LIST_DIR}/dubsar_${name}_target.cmake\")\n")
  file(WRITE ${CMAKE_BINARY_DIR}/config/dubsar_${name}.cmake "${text}")
  install(FILES ${CMAKE_BINARY_DIR}/config/dubsar_${name}.cmake
    DESTINATION ${DUBSAR_INSTALL_CONFIG} COMPONENT development)
endfunction()

configure_package_config_file(${CMAKE_SOURCE_DIR}/cmake/dubsarConfig.cmake.in
  ${CMAKE_BINARY_DIR}/config/dubsarConfig.cmake INSTALL_DESTINATION ${DUBSAR_INSTALL_CONFIG})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/config/dubsarConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/config/dubsarConfig.cmake ${CMAKE_BINARY_DIR}/config/dubsarConfigVersion.cmake
  DESTINATION ${DUBSAR_INSTALL_CONFIG} COMPONENT development)
