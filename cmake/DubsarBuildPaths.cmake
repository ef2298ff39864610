# dubsar_build_paths: a header with the folders of the source and of the build, for tests and benchmarks that start programs
# or read files of the tree. A header and no compile definition, so that only what includes it differs from clone to clone
# and the compiler cache serves all the rest.
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/generated/build_paths.h @ONLY CONTENT [[
#pragma once
#define DUBSAR_SOURCE_DIR "@CMAKE_SOURCE_DIR@"
#define DUBSAR_BINARY_DIR "@CMAKE_BINARY_DIR@"
]])
add_library(dubsar_build_paths INTERFACE)
target_include_directories(dubsar_build_paths INTERFACE ${CMAKE_BINARY_DIR}/generated)
