#include "dynasurf/io/detail/dicom_load.hpp"

#include <vector>

#include <dcmtk/dcmdata/dcistrmb.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/byte_source.hpp"

namespace dynasurf::io::dicom {
namespace {

E_TransferSyntax syntax_of(const DicomOutline& outline) {
  if (!outline.explicit_vr) return EXS_LittleEndianImplicit;
  return outline.big_endian ? EXS_BigEndianExplicit : EXS_LittleEndianExplicit;
}

}  // namespace

std::unique_ptr<DcmDataset> load_wanted(const std::filesystem::path& path, const DicomOutline& outline) {
  // An explicit file may still hold implicit values, in sequences of kind UN. Whoever made the outline of those has
  // asked the dictionary, so it is there.
  outline.explicit_vr ? prepare_dcmtk() : require_dictionary();
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

}  // namespace dynasurf::io::dicom
