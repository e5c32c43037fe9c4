# Warns in a workspace that tools/run has not set up: there this package builds, and no launch file works.

set(MISSING_PACKAGES "")
get_filename_component(BESIDE "${CMAKE_CURRENT_SOURCE_DIR}" DIRECTORY)
foreach(package gazebo_msgs gazebo_ros my_simulations_msgs xacro)
  execute_process(
    COMMAND sh -c
      "ROS_PACKAGE_PATH='${CMAKE_SOURCE_DIR}:${BESIDE}':$ROS_PACKAGE_PATH rospack find ${package}"
    RESULT_VARIABLE status OUTPUT_QUIET ERROR_QUIET)
  if(NOT status EQUAL 0)
    list(APPEND MISSING_PACKAGES ${package})
  endif()
endforeach()
if(MISSING_PACKAGES)
  string(REPLACE ";" ", " MISSING_PACKAGES "${MISSING_PACKAGES}")
  message(WARNING "my_simulations needs ${MISSING_PACKAGES}, which this workspace does not have.\n"
    "Run this once; it links or installs what is missing, and builds the workspace:\n"
    "  ${CMAKE_CURRENT_SOURCE_DIR}/tools/run --set-up-only\n"
    "Without it roslaunch ends with \"Resource not found: gazebo_ros\".")
endif()
