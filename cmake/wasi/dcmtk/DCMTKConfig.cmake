# find_package(DCMTK) for WebAssembly: dcmdata with what it needs, in one library.
if(NOT TARGET DCMTK::DCMTK)
  add_library(DCMTK::DCMTK STATIC IMPORTED)
  set_target_properties(DCMTK::DCMTK PROPERTIES IMPORTED_LOCATION ${DYNASURF_WASI_PREFIX}/lib/libdcmdata.a
                        INTERFACE_LINK_LIBRARIES ${DYNASURF_WASI_PREFIX}/lib/libz.a)
endif()
set(DCMTK_FOUND TRUE)
set(DCMTK_LIBRARIES DCMTK::DCMTK)
set(DCMTK_INCLUDE_DIRS ${DYNASURF_WASI_PREFIX}/include)
