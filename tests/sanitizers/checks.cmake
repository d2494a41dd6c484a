# Included by project() of cpp/CMakeLists.txt, which knows nothing of it; the rest waits for its end.
set(checks "${CMAKE_CURRENT_LIST_DIR}")

function(add_checks)
  Python3_add_library(planted MODULE WITH_SOABI "${checks}/planted.cpp")
  target_compile_features(planted PRIVATE cxx_std_20)
  target_link_libraries(planted PRIVATE ngsolve)
  if(NGSLAC_CHECKS STREQUAL "range")
    foreach(target _ngslac planted)
      target_sources(${target} PRIVATE "${checks}/rangefailure.cpp")
      target_link_options(${target} PRIVATE -Wl,-Bsymbolic-functions) # calls that, no other
    endforeach()
    set_source_files_properties("${checks}/rangefailure.cpp" PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    set_target_properties(_ngslac PROPERTIES
      PRECOMPILE_HEADERS "${checks}/rangechecks.hpp;<comp.hpp>")
  endif()
  target_precompile_headers(planted REUSE_FROM _ngslac)
endfunction()

cmake_language(DEFER CALL add_checks)
