# cmake -DOUT=FILE -P notices.cmake: the licences of what is compiled into the programs (templates, headers and static
# libraries of others), each as Debian tells it of the very version that was used.
set(packages libeigen3-dev libcli11-dev nlohmann-json3-dev libtomlplusplus-dev libimgui-dev libflann-dev libfmt-dev
  libspdlog-dev libtbb-dev libembree-dev libceres-dev libopencv-dev libdraco-dev)
if(PYTHON)
  list(APPEND packages pybind11-dev)
endif()
set(text "Dubsar is under the Apache License 2.0. Parts of these projects are compiled into its programs.\n")
foreach(package ${packages})
  set(file /usr/share/doc/${package}/copyright)
  if(NOT EXISTS ${file})
    message(FATAL_ERROR "${file}: the licence of ${package} is not there; reinstall it without excluding /usr/share/doc")
  endif()
  file(READ ${file} licence)
  string(APPEND text "\n${package}\n" "================================================================\n" "${licence}")
endforeach()
file(WRITE ${OUT} "${text}")
