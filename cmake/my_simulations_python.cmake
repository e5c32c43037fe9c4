# Executables in Python that start with the interpreter the workspace is built with.
#
# catkin_install_python gives the devel space a relay with that interpreter's path; what it installs
# keeps "#!/usr/bin/env python3", which outside the devel space finds a Python without PyBullet. So
# the installed copies get the same path.

# The workspace's own interpreter, also for a catkin_make that was not told of it.
set(MY_SIMULATIONS_PYTHON "${CMAKE_SOURCE_DIR}/../.my_simulations/venv/bin/python3")
get_filename_component(MY_SIMULATIONS_PYTHON "${MY_SIMULATIONS_PYTHON}" ABSOLUTE)
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
