# Executables in Python that start with the interpreter the workspace is built with.
#
# catkin_install_python gives the devel space a relay with that interpreter's path; what it installs
# keeps "#!/usr/bin/env python3", which outside the devel space finds a Python without PyBullet. So
# the installed copies get the same path.

function(my_simulations_install_python)
  cmake_parse_arguments(ARG "" "DESTINATION" "PROGRAMS" ${ARGN})
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
