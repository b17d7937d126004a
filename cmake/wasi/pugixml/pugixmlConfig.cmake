# find_package(pugixml) for WebAssembly.
if(NOT TARGET pugixml::pugixml)
  add_library(pugixml::pugixml STATIC IMPORTED)
  set_target_properties(pugixml::pugixml PROPERTIES IMPORTED_LOCATION ${DYNASURF_WASI_PREFIX}/lib/libpugixml.a)
endif()
