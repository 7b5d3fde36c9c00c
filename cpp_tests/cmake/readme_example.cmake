# The README's C++ example is the program that is compiled and run: cmake -D README=... -D EXAMPLE=... -P ...
cmake_minimum_required(VERSION 3.21)
file(READ ${README} readme)
file(READ ${EXAMPLE} example)
string(FIND "${readme}" "```cpp\n${example}```" at)
if(at EQUAL -1)
  message(FATAL_ERROR "${README} does not contain ${EXAMPLE} word for word as a ```cpp block")
endif()
