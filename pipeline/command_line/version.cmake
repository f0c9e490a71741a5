# Writes OUTPUT, a C++ file that defines pvg::program_version(), when its text changes. Called at each build with
# SOURCE (the checkout), VERSION and OUTPUT.
set(built "built outside of a git checkout")
find_package(Git QUIET)
if(GIT_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} describe --always --dirty --match=v[0-9]* WORKING_DIRECTORY ${SOURCE}
                  OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(built "commit ${described}")
  endif()
endif()
string(CONCAT text "#include \"pipeline/command_line/program.hpp\"\n\n"
       "std::string pvg::program_version() { return \"${VERSION} (${built})\"; }\n")
set(before "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} before)
endif()
if(NOT text STREQUAL before)
  file(WRITE ${OUTPUT} "${text}")
endif()
