#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "support/dicom_edit.hpp"
#include "support/l_shape.hpp"
#include "support/mutations.hpp"
#include "support/scratch_folder.hpp"

namespace dynasurf::test {

/// A study as one DICOM file, and the same changed.
class DicomFile : public ::testing::Test {
 protected:
  ScratchFolder scratch;
  const Study truth = l_shape_study(oblique_grid(), 4);

  std::filesystem::path written(const Study& study) {
    io::write_dicom(study, scratch / "written.dcm");
    return scratch / "written.dcm";
  }
  std::filesystem::path changed(const std::function<void(DcmDataset&)>& change,
                                E_TransferSyntax syntax = EXS_LittleEndianExplicit) {
    edit_dicom(written(truth), scratch / "changed.dcm", change, syntax);
    return scratch / "changed.dcm";
  }
  std::string refusal(const std::function<void(DcmDataset&)>& change) { return refusal_of(changed(change)); }
};

}  // namespace dynasurf::test
