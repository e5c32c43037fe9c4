# rostest as a target of `catkin_make run_tests`. Debian's rostest comes without its CMake side, so
# where find_package finds none the target is made here, the same way.

find_package(rostest QUIET)

function(my_simulations_add_rostest test)
  if(COMMAND add_rostest)
    add_rostest(${test})
    return()
  endif()
  get_filename_component(name ${test} NAME_WE)
  set(command "rostest --pkgdir=${PROJECT_SOURCE_DIR} --package=${PROJECT_NAME}")
  set(command "${command} --results-filename=rostest-${name}.xml")
  set(command "${command} --results-base-dir=${CATKIN_TEST_RESULTS_DIR}")
  set(command "${command} ${PROJECT_SOURCE_DIR}/${test}")
  catkin_run_tests_target("rostest" ${name} "rostest-${name}.xml" COMMAND "${command}")
endfunction()
