#include "dynasurf/io/detail/dicom_dictionary.hpp"

#include <cstddef>
#include <cstdlib>
#include <mutex>
#include <optional>

#include <dcmtk/config/osconfig.h>
// DCMTK asks for its configuration header first.
#include <dcmtk/dcmdata/dctk.h>

#include "dynasurf/core/detail/memory_limit.hpp"
#include "dynasurf/core/error.hpp"

namespace dynasurf::io::dicom {
namespace {

bool was_left_unread = false;  // set before there are threads

/// DCMTK reads its dictionary, 2 MB in memory, without a look at whether there is memory.
void require_room_for_dictionary() { require_room(std::size_t{8} << 20); }

DcmTag with_kind(std::uint32_t tag) {
  require_dictionary();
  return {static_cast<Uint16>(tag >> 16), static_cast<Uint16>(tag & 0xffff)};
}

}  // namespace

void leave_dictionary_unread() {
#if DCM_DICT_DEFAULT == DCM_DICT_DEFAULT_USE_EXTERNAL
  const char* const set = std::getenv(DCM_DICT_ENVIRONMENT_VARIABLE);
  const std::optional<std::string> path = set ? std::optional<std::string>(set) : std::nullopt;
  ::setenv(DCM_DICT_ENVIRONMENT_VARIABLE, "/dev/null", 1);
  OFLog::configure(OFLogger::OFF_LOG_LEVEL);
  dcmDataDict.rdlock();  // the first question makes it, here of nothing
  dcmDataDict.rdunlock();
  if (path)
    ::setenv(DCM_DICT_ENVIRONMENT_VARIABLE, path->c_str(), 1);
  else
    ::unsetenv(DCM_DICT_ENVIRONMENT_VARIABLE);
  was_left_unread = true;
#endif
}

void prepare_dcmtk() {
  static std::once_flag once;
  std::call_once(once, [] {
    OFLog::configure(OFLogger::OFF_LOG_LEVEL);
    if (was_left_unread) return;
    require_room_for_dictionary();
    dcmDataDict.rdlock();
    dcmDataDict.rdunlock();
  });
}

void require_dictionary() {
  prepare_dcmtk();
  static std::once_flag once;
  std::call_once(once, [] {
    if (!was_left_unread) return;
    require_room_for_dictionary();
    dcmDataDict.wrlock().reloadDictionaries(OFFalse, OFTrue);
    dcmDataDict.wrunlock();
  });
  if (!dcmDataDict.isDictionaryLoaded())
    throw IoError("DCMTK's dictionary dicom.dic is not found: install package libdcmtk17 or set DCMDICTPATH");
}

bool is_sequence(std::uint32_t tag) { return with_kind(tag).getEVR() == EVR_SQ; }

std::string name_of(std::uint32_t tag) { return with_kind(tag).getTagName(); }

}  // namespace dynasurf::io::dicom
