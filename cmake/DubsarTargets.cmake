# dubsar_library(NAME SOURCES a.cpp ... LINKS dubsar_core ... [PRIVATE lib ...])
# One static library per folder, named dubsar_<folder>. LINKS are public: what the folder's headers need.
function(dubsar_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS;PRIVATE" ${ARGN})
  add_library(dubsar_${name} STATIC ${ARG_SOURCES})
  target_include_directories(dubsar_${name} PUBLIC ${CMAKE_SOURCE_DIR})
  target_link_libraries(dubsar_${name} PUBLIC ${ARG_LINKS} PRIVATE dubsar_options ${ARG_PRIVATE})
endfunction()

# dubsar_test(NAME SOURCES a_test.cpp ... LINKS dubsar_core ... [LABEL unit])
# One GoogleTest executable per module, its tests known to ctest one by one.
function(dubsar_test name)
  cmake_parse_arguments(ARG "" "LABEL" "SOURCES;LINKS" ${ARGN})
  if(NOT ARG_LABEL)
    set(ARG_LABEL unit)
  endif()
  add_executable(${name}_test ${ARG_SOURCES})
  target_include_directories(${name}_test PRIVATE ${CMAKE_SOURCE_DIR})
  target_link_libraries(${name}_test PRIVATE dubsar_options ${ARG_LINKS} GTest::gmock GTest::gtest_main)
  # Where the real scans lie when the project has them beside it; $DUBSAR_DATA wins at run time.
  target_compile_definitions(${name}_test PRIVATE DUBSAR_SOURCE_DIR="${CMAKE_SOURCE_DIR}"
    DUBSAR_BINARY_DIR="${CMAKE_BINARY_DIR}")
  gtest_discover_tests(${name}_test DISCOVERY_MODE PRE_TEST PROPERTIES LABELS ${ARG_LABEL} TIMEOUT 300)
endfunction()
