# Executables in Python that start with the interpreter the workspace is built with.
#
# catkin_install_python gives the devel space a relay with that interpreter's path; what it installs
# keeps "#!/usr/bin/env python3", which outside the devel space finds a Python without PyBullet. So
# the installed copies get the same path.

# The folder .my_simulations of the workspace, which tools/run makes: it lies above the sources and above
# the devel space, whether catkin_make, catkin build or catkin_make_isolated builds.
function(my_simulations_find_own result)
  foreach(start "${CMAKE_SOURCE_DIR}" "${CATKIN_DEVEL_PREFIX}")
    get_filename_component(above "${start}" ABSOLUTE)
    set(folder "")
    while(NOT "${above}" STREQUAL "${folder}")
      set(folder "${above}")
      if(IS_DIRECTORY "${folder}/.my_simulations/venv")
        set(${result} "${folder}/.my_simulations" PARENT_SCOPE)
        return()
      endif()
      get_filename_component(above "${folder}" DIRECTORY)
    endwhile()
  endforeach()
  set(${result} "${CMAKE_SOURCE_DIR}/../.my_simulations" PARENT_SCOPE)
endfunction()
my_simulations_find_own(MY_SIMULATIONS_OWN)

# The workspace's own interpreter, also for a build that was not told of it.
set(MY_SIMULATIONS_PYTHON "${MY_SIMULATIONS_OWN}/venv/bin/python3")
if(NOT EXISTS "${MY_SIMULATIONS_PYTHON}")
  set(MY_SIMULATIONS_PYTHON "${PYTHON_EXECUTABLE}")
endif()

function(my_simulations_install_python)
  cmake_parse_arguments(ARG "" "DESTINATION" "PROGRAMS" ${ARGN})
  set(PYTHON_EXECUTABLE "${MY_SIMULATIONS_PYTHON}")  # what catkin's template writes
  catkin_install_python(PROGRAMS ${ARG_PROGRAMS} DESTINATION ${ARG_DESTINATION})
  foreach(program ${ARG_PROGRAMS})
    get_filename_component(name ${program} NAME)
    install(CODE "
      set(installed \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${ARG_DESTINATION}/${name}\")
      file(READ \"\${installed}\" text)
      string(REGEX REPLACE \"^#![^\\n]*\" \"#!${PYTHON_EXECUTABLE}\" text \"\${text}\")
      file(WRITE \"\${installed}\" \"\${text}\")
    ")
  endforeach()
endfunction()

# Programs for the devel space alone, in one of its folders; nothing is installed.
function(my_simulations_relay_python)
  cmake_parse_arguments(ARG "" "DESTINATION" "PROGRAMS" ${ARGN})
  set(PYTHON_EXECUTABLE "${MY_SIMULATIONS_PYTHON}")
  foreach(program ${ARG_PROGRAMS})
    get_filename_component(PYTHON_SCRIPT ${program} ABSOLUTE)
    get_filename_component(name ${program} NAME)
    set(relay "${CMAKE_CURRENT_BINARY_DIR}/relays/${name}")
    configure_file(${catkin_EXTRAS_DIR}/templates/script.py.in "${relay}" @ONLY)
    file(COPY "${relay}" DESTINATION ${CATKIN_DEVEL_PREFIX}/${ARG_DESTINATION}
      FILE_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
                       WORLD_READ WORLD_EXECUTE)
  endforeach()
endfunction()
