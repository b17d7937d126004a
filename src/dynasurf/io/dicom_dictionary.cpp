#include "dynasurf/io/detail/dicom_dictionary.hpp"

#include <cstddef>
#include <mutex>

#include <dcmtk/config/osconfig.h>
// DCMTK asks for its configuration header first.
#include <dcmtk/dcmdata/dctk.h>

#include "dynasurf/core/detail/memory_limit.hpp"
#include "dynasurf/core/error.hpp"

namespace dynasurf::io::dicom {

void prepare_dcmtk() {
  static std::once_flag once;
  std::call_once(once, [] {
    OFLog::configure(OFLogger::OFF_LOG_LEVEL);
    // DCMTK reads its dictionary, 2 MB in memory, without a look at whether there is memory.
    require_room(std::size_t{8} << 20);
    dcmDataDict.rdlock();
    dcmDataDict.rdunlock();
  });
}

void require_dictionary() {
  prepare_dcmtk();
  if (!dcmDataDict.isDictionaryLoaded())
    throw IoError("DCMTK's dictionary dicom.dic is not found: install package libdcmtk17 or set DCMDICTPATH");
}

bool is_sequence(std::uint32_t tag) {
  require_dictionary();
  return DcmTag(static_cast<Uint16>(tag >> 16), static_cast<Uint16>(tag & 0xffff)).getEVR() == EVR_SQ;
}

}  // namespace dynasurf::io::dicom
