# find_package(meshoptimizer) for WebAssembly.
if(NOT TARGET meshoptimizer::meshoptimizer)
  add_library(meshoptimizer::meshoptimizer STATIC IMPORTED)
  set_target_properties(meshoptimizer::meshoptimizer PROPERTIES IMPORTED_LOCATION ${DYNASURF_WASI_PREFIX}/lib/libmeshoptimizer.a)
endif()
