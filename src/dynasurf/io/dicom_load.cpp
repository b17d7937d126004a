#include "dynasurf/io/detail/dicom_load.hpp"

#include <mutex>
#include <vector>

#include <dcmtk/dcmdata/dcistrmb.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/byte_source.hpp"

namespace dynasurf::io::dicom {
namespace {

void require_dictionary() {
  prepare_dcmtk();
  if (!dcmDataDict.isDictionaryLoaded())
    throw IoError("DCMTK's dictionary dicom.dic is not found: install package libdcmtk17 or set DCMDICTPATH");
}

E_TransferSyntax syntax_of(const DicomOutline& outline) {
  if (!outline.explicit_vr) return EXS_LittleEndianImplicit;
  return outline.big_endian ? EXS_BigEndianExplicit : EXS_LittleEndianExplicit;
}

}  // namespace

void prepare_dcmtk() {
  static std::once_flag once;
  std::call_once(once, [] {
    OFLog::configure(OFLogger::OFF_LOG_LEVEL);
    // DCMTK reads its dictionary, 2 MB in memory, without a look at whether there is memory: here one looks.
    { const std::vector<std::byte> dictionary(std::size_t{8} << 20); }
    dcmDataDict.rdlock();
    dcmDataDict.rdunlock();
  });
}

std::unique_ptr<DcmDataset> load_wanted(const std::filesystem::path& path, const DicomOutline& outline) {
  require_dictionary();
  FileWindow file(path);
  std::vector<std::byte> bytes;
  for (const FilePiece& piece : outline.wanted) {
    const std::size_t begin = bytes.size();
    bytes.resize(begin + piece.size());
    file.read(piece.begin, std::span(bytes).subspan(begin), "header");
  }
  auto dataset = std::make_unique<DcmDataset>();
  if (bytes.empty()) return dataset;
  DcmInputBufferStream stream;
  stream.setBuffer(bytes.data(), static_cast<offile_off_t>(bytes.size()));
  stream.setEos();
  dataset->transferInit();
  const OFCondition status = dataset->read(stream, syntax_of(outline), EGL_noChange);
  dataset->transferEnd();
  if (status.bad())
    throw InputError(path.string() + ": is damaged or cut off: DICOM reading stops with \"" + status.text() + "\"");
  return dataset;
}

bool is_sequence(std::uint32_t tag) {
  require_dictionary();
  return DcmTag(static_cast<Uint16>(tag >> 16), static_cast<Uint16>(tag & 0xffff)).getEVR() == EVR_SQ;
}

}  // namespace dynasurf::io::dicom
