# dubsar_library(NAME SOURCES a.cpp ... LINKS dubsar_core ... [PRIVATE lib ...] [NEEDS line ...] [OWN])
# One static library per folder, named dubsar_<folder>. LINKS are public: what the folder's headers need. It is installed
# as component <folder> of find_package(dubsar); NEEDS are the lines that its configuration needs beside the components
# that it links ("find_dependency(TBB)", "dubsar_pkg(zstd libzstd)"). OWN libraries are not installed.
function(dubsar_library name)
  cmake_parse_arguments(ARG "OWN" "" "SOURCES;LINKS;PRIVATE;NEEDS" ${ARGN})
  add_library(dubsar_${name} STATIC ${ARG_SOURCES})
  target_include_directories(dubsar_${name} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/dubsar>)
  target_compile_features(dubsar_${name} PUBLIC cxx_std_23)
  target_link_libraries(dubsar_${name} PUBLIC ${ARG_LINKS} PRIVATE $<BUILD_INTERFACE:dubsar_options> ${ARG_PRIVATE})
  if(NOT ARG_OWN)
    dubsar_install_library(${name} "${ARG_LINKS}" "${ARG_NEEDS}")
  endif()
endfunction()

# dubsar_test(NAME SOURCES a_test.cpp ... LINKS dubsar_core ... [LABEL unit] [ALONE] [WHOLE Suite ...] [WAITS Suite ...])
# One GoogleTest executable per module, its tests known to ctest one by one, each in a process of its own. ALONE: no other
# test runs beside these, but for suites that WAIT. Suites that are WHOLE run in one process each: what they set up takes
# longer than their tests. Suites that WAIT for devices leave the processors to others: they come first, one test at a time,
# beside those that compute (./test runs one test more than there are cores). WAITS * is all of them.
function(dubsar_test name)
  cmake_parse_arguments(ARG "ALONE" "LABEL" "SOURCES;LINKS;WHOLE;WAITS" ${ARGN})
  if(NOT ARG_LABEL)
    set(ARG_LABEL unit)
  endif()
  add_executable(${name}_test ${ARG_SOURCES})
  target_include_directories(${name}_test PRIVATE ${CMAKE_SOURCE_DIR})
  target_link_libraries(${name}_test PRIVATE dubsar_options ${ARG_LINKS} GTest::gmock GTest::gtest_main)
  target_link_libraries(${name}_test PRIVATE dubsar_build_paths)
  if(DUBSAR_SANITIZE)
    target_compile_definitions(${name}_test PRIVATE DUBSAR_SANITIZED)
  endif()
  set(properties LABELS ${ARG_LABEL} TIMEOUT 300 RUN_SERIAL ${ARG_ALONE})
  set(waiting LABELS ${ARG_LABEL} TIMEOUT 300 RESOURCE_LOCK waiting COST 1000)
  set(apart ${ARG_WHOLE})
  if(ARG_WAITS STREQUAL "*")
    set(properties ${waiting})
  elseif(ARG_WAITS)
    list(APPEND apart ${ARG_WAITS})
    list(TRANSFORM ARG_WAITS APPEND ".*")
    list(JOIN ARG_WAITS ":" waits)
    gtest_discover_tests(${name}_test TEST_FILTER "${waits}" TEST_LIST ${name}_waiting DISCOVERY_MODE PRE_TEST
      PROPERTIES ${waiting})
  endif()
  list(TRANSFORM apart APPEND ".*")
  list(JOIN apart ":" apart)
  gtest_discover_tests(${name}_test TEST_FILTER "*-${apart}" DISCOVERY_MODE PRE_TEST PROPERTIES ${properties})
  foreach(suite ${ARG_WHOLE})
    add_test(NAME ${suite} COMMAND ${name}_test --gtest_filter=${suite}.*)
    set_tests_properties(${suite} PROPERTIES LABELS ${ARG_LABEL} TIMEOUT 900 RUN_SERIAL ${ARG_ALONE}
      FAIL_REGULAR_EXPRESSION "Running 0 tests")
  endforeach()
endfunction()
