#pragma once
#include <functional>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include <dcmtk/config/osconfig.h>
// DCMTK asks for its configuration header first.
#include <dcmtk/dcmdata/dcrleerg.h>
#include <dcmtk/dcmdata/dcrlerp.h>
#include <dcmtk/dcmdata/dctk.h>

#include "dynasurf/core/study.hpp"
#include "dynasurf/io/study_io.hpp"

#include "support/scratch_folder.hpp"

namespace dynasurf::test {

inline void check(const OFCondition& status) {
  if (status.bad()) throw std::logic_error(status.text());
}

/// Writes a changed copy of a DICOM file, in the transfer syntax asked for.
inline void edit_dicom(const std::filesystem::path& from, const std::filesystem::path& to,
                       const std::function<void(DcmDataset&)>& change,
                       E_TransferSyntax syntax = EXS_LittleEndianExplicit, E_FileWriteMode mode = EWM_fileformat) {
  DcmFileFormat file;
  check(file.loadFile(from.c_str()));
  check(file.loadAllDataIntoMemory());
  change(*file.getDataset());
  if (syntax == EXS_RLELossless) {
    DcmRLEEncoderRegistration::registerCodecs();
    const DcmRLERepresentationParameter parameter;
    check(file.getDataset()->chooseRepresentation(syntax, &parameter));
  }
  check(file.saveFile(to.c_str(), syntax, EET_ExplicitLength, EGL_recalcGL, EPD_noChange, 0, 0, mode));
}

inline void put(DcmItem& item, const DcmTagKey& tag, const std::string& value) {
  check(item.putAndInsertString(tag, value.c_str()));
}
inline void put(DcmItem& item, const DcmTagKey& tag, const std::vector<Uint16>& values) {
  check(item.putAndInsertUint16Array(tag, values.data(), values.size()));
}
inline void drop(DcmItem& item, const DcmTagKey& tag) { check(item.findAndDeleteElement(tag)); }

inline DcmItem& item_of(DcmItem& parent, const DcmTagKey& tag, signed long number = 0) {
  DcmItem* item = nullptr;
  check(parent.findOrCreateSequenceItem(tag, item, number));
  return *item;
}

inline std::vector<Uint16> words_of(DcmItem& item, const DcmTagKey& tag) {
  const Uint16* words = nullptr;
  unsigned long count = 0;
  check(item.findAndGetUint16Array(tag, words, &count));
  return {words, words + count};
}

/// Puts frame `order[n]` at place n, in the pixels and in every vector of the frames.
inline void reorder_frames(DcmDataset& dataset, const std::vector<std::size_t>& order) {
  for (const DcmTagKey& tag : {DCM_RRIntervalVector, DCM_TimeSlotVector, DCM_SliceVector, DCM_PixelData}) {
    const auto old = words_of(dataset, tag);
    const std::size_t width = old.size() / order.size();
    std::vector<Uint16> now;
    for (const std::size_t frame : order)
      now.insert(now.end(), old.begin() + static_cast<std::ptrdiff_t>(frame * width),
                 old.begin() + static_cast<std::ptrdiff_t>((frame + 1) * width));
    put(dataset, tag, now);
  }
}

/// A PET-style folder: one file per gate and slice, named so that the order of names says nothing.
/// `tell_gate` writes what tells the gates apart.
inline void write_single_frames(const Study& study, const std::filesystem::path& folder,
                                const std::function<void(DcmDataset&, int gate)>& tell_gate) {
  std::filesystem::create_directories(folder);
  io::write_dicom(study, folder / "whole");
  DcmFileFormat whole;
  check(whole.loadFile((folder / "whole").c_str()));
  check(whole.loadAllDataIntoMemory());
  std::filesystem::remove(folder / "whole");
  const Grid& g = study.grid();
  const auto pixels = words_of(*whole.getDataset(), DCM_PixelData);
  const std::size_t size = g.size() / static_cast<std::size_t>(g.dims[2]);
  const auto decimals = [](const Vec3& v) {
    char text[60];
    std::snprintf(text, sizeof text, "%.8f\\%.8f\\%.8f", v[0], v[1], v[2]);
    return std::string(text);
  };
  for (int gate = 0; gate < static_cast<int>(study.gates.size()); ++gate)
    for (int k = 0; k < g.dims[2]; ++k) {
      const int n = gate * g.dims[2] + k;
      DcmFileFormat one(whole);
      DcmDataset& d = *one.getDataset();
      for (const DcmTagKey& tag :
           {DCM_NumberOfFrames, DCM_FrameIncrementPointer, DCM_RRIntervalVector, DCM_TimeSlotVector, DCM_SliceVector,
            DCM_NumberOfRRIntervals, DCM_NumberOfTimeSlots, DCM_NumberOfSlices, DCM_GatedInformationSequence,
            DCM_DetectorInformationSequence, DCM_SpacingBetweenSlices})
        d.findAndDeleteElement(tag);
      put(d, DCM_SOPClassUID, UID_PositronEmissionTomographyImageStorage);
      put(d, DCM_Modality, "PT");
      put(d, DCM_ImageType, "ORIGINAL\\PRIMARY");
      put(d, DCM_SOPInstanceUID, "2.25." + std::to_string(1000 + n));
      put(d, DCM_InstanceNumber, std::to_string(n + 1));
      put(d, DCM_ImagePositionPatient, decimals(to_world(g, centre_of(g, {0, 0, k}))));
      put(d, DCM_ImageOrientationPatient, decimals(g.direction.col(0)) + "\\" + decimals(g.direction.col(1)));
      const auto first = pixels.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(n) * size);
      put(d, DCM_PixelData, std::vector<Uint16>(first, first + static_cast<std::ptrdiff_t>(size)));
      tell_gate(d, gate);
      check(one.saveFile((folder / ("i" + std::to_string(n * 37 % 101) + "_" + std::to_string(n))).c_str(),
                         EXS_LittleEndianExplicit));
    }
}

}  // namespace dynasurf::test
