# Writes data sets with the command: cmake -D COMMAND=.../wellspaced -D DIR=... -D NAMES=a,b -P datasets.cmake
cmake_minimum_required(VERSION 3.21)
file(MAKE_DIRECTORY ${DIR})
string(REPLACE "," ";" NAMES "${NAMES}")
foreach(name ${NAMES})
  execute_process(COMMAND ${COMMAND} dataset ${name} OUTPUT_FILE ${DIR}/${name}.poly RESULT_VARIABLE result
                  ERROR_VARIABLE error)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "wellspaced dataset ${name}: ${error}")
  endif()
endforeach()
