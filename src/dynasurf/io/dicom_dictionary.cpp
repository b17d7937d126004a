#include "dynasurf/io/detail/dicom_dictionary.hpp"

#include <cstddef>
#include <memory>
#include <mutex>

#include <dcmtk/config/osconfig.h>
// DCMTK asks for its configuration header first.
#include <dcmtk/dcmdata/dctk.h>

#include "dynasurf/core/error.hpp"

namespace dynasurf::io::dicom {

void prepare_dcmtk() {
  static std::once_flag once;
  std::call_once(once, [] {
    OFLog::configure(OFLogger::OFF_LOG_LEVEL);
    // DCMTK reads its dictionary, 2 MB in memory, without a look at whether there is memory: here one looks. Room of
    // which one byte alone is written is neither left out by the compiler nor fetched by the system.
    {
      const auto dictionary = std::make_unique_for_overwrite<std::byte[]>(std::size_t{8} << 20);
      *static_cast<volatile std::byte*>(dictionary.get()) = std::byte{};
    }
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
