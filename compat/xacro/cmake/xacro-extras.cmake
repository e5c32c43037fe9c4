# What packages get that find_package(catkin REQUIRED COMPONENTS xacro): functions that expand xacro
# files at build time, with the names and arguments they have in Noetic.

if(NOT TARGET xacro_expanded_to_devel)
  add_custom_target(xacro_expanded_to_devel ALL)
endif()

# xacro_add_xacro_file(<input> [<output>] [REMAP <arg:=value>...] [OUTPUT <variable>]
#                      [DEPENDS <file>...])
#
# A build rule that expands <input> into <output>, by default its name without `.xacro`. The output's
# path goes to XACRO_OUTPUT_FILE, or to <variable>. Made again when any file it includes changes.
function(xacro_add_xacro_file input)
  cmake_parse_arguments(ARG "" "OUTPUT" "REMAP;DEPENDS" ${ARGN})
  list(LENGTH ARG_UNPARSED_ARGUMENTS more)
  if(more GREATER 0)
    list(GET ARG_UNPARSED_ARGUMENTS 0 output)
  elseif(input MATCHES "(.*)[.]xacro$")
    set(output ${CMAKE_MATCH_1})
  else()
    message(FATAL_ERROR "xacro_add_xacro_file: name an output for ${input}")
  endif()
  if(NOT IS_ABSOLUTE ${output})
    set(output ${CMAKE_CURRENT_BINARY_DIR}/${output})
  endif()
  get_filename_component(folder ${output} DIRECTORY)
  execute_process(COMMAND ${CATKIN_ENV} xacro --deps ${input} ${ARG_REMAP}
    WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} RESULT_VARIABLE failed
    OUTPUT_VARIABLE includes ERROR_VARIABLE said OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(failed)
    message(WARNING "xacro cannot tell what ${input} includes:\n${said}")
    set(includes "")
  endif()
  separate_arguments(includes)
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${folder}
    COMMAND ${CATKIN_ENV} xacro -o ${output} ${input} ${ARG_REMAP}
    DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${input} ${includes} ${ARG_DEPENDS}
    WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} COMMENT "xacro: ${input}")
  if(ARG_OUTPUT)
    set(${ARG_OUTPUT} ${output} PARENT_SCOPE)
  else()
    set(XACRO_OUTPUT_FILE ${output} PARENT_SCOPE)
  endif()
endfunction()

# xacro_install(<target> <file>... [DESTINATION <folder>])
#
# Copies expanded files to the package's share folder, in the devel and in the install space.
function(xacro_install target)
  cmake_parse_arguments(ARG "" "DESTINATION" "" ${ARGN})
  set(destination ${CATKIN_PACKAGE_SHARE_DESTINATION}/${ARG_DESTINATION})
  set(copies "")
  foreach(file ${ARG_UNPARSED_ARGUMENTS})
    get_filename_component(name ${file} NAME)
    set(copy ${CATKIN_DEVEL_PREFIX}/${destination}/${name})
    add_custom_command(OUTPUT ${copy} DEPENDS ${file}
      COMMAND ${CMAKE_COMMAND} -E make_directory ${CATKIN_DEVEL_PREFIX}/${destination}
      COMMAND ${CMAKE_COMMAND} -E copy_if_different ${file} ${copy})
    list(APPEND copies ${copy})
  endforeach()
  add_custom_target(${PROJECT_NAME}_${target}_to_devel DEPENDS ${copies})
  add_dependencies(xacro_expanded_to_devel ${PROJECT_NAME}_${target}_to_devel)
  install(FILES ${ARG_UNPARSED_ARGUMENTS} DESTINATION ${destination})
endfunction()

# xacro_add_files(<file>... [REMAP <arg:=value>...] [DEPENDS <file>...] [TARGET <target>]
#                 [INSTALL [DESTINATION <folder>]])
#
# Expands all the files with the target, by default with everything.
function(xacro_add_files)
  cmake_parse_arguments(ARG "INSTALL" "OUTPUT;TARGET;DESTINATION" "REMAP;DEPENDS" ${ARGN})
  set(outputs "")
  foreach(input ${ARG_UNPARSED_ARGUMENTS})
    xacro_add_xacro_file(${input} ${ARG_OUTPUT} REMAP ${ARG_REMAP} DEPENDS ${ARG_DEPENDS})
    list(APPEND outputs ${XACRO_OUTPUT_FILE})
  endforeach()
  if(NOT outputs)
    return()
  endif()
  if(NOT ARG_TARGET)
    set(ARG_TARGET xacro_files)
  endif()
  add_custom_target(${PROJECT_NAME}_${ARG_TARGET} ALL DEPENDS ${outputs})
  if(ARG_INSTALL)
    xacro_install(${ARG_TARGET} ${outputs} DESTINATION ${ARG_DESTINATION})
    add_dependencies(${PROJECT_NAME}_${ARG_TARGET}_to_devel ${PROJECT_NAME}_${ARG_TARGET})
  endif()
endfunction()
