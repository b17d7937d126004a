#include <cstdio>
#include <cstdlib>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/io/study_io.hpp"

#include "support/l_shape.hpp"
#include "support/scratch_folder.hpp"

namespace dynasurf::io {
namespace {

bool is_installed(const std::string& command) {
  return std::system(("command -v " + command + " > /dev/null").c_str()) == 0;
}

/// What a command prints on both channels.
std::string output_of(const std::string& command) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(::popen((command + " 2>&1").c_str(), "r"), ::pclose);
  std::string text;
  char block[512];
  while (pipe && std::fgets(block, sizeof block, pipe.get())) text += block;
  return text;
}

std::vector<Study> studies() {
  std::vector<Study> all;
  for (const bool left_handed : {false, true})
    for (const int gates : {1, 3}) {
      all.push_back(test::l_shape_study(test::oblique_grid(left_handed), gates));
      all.push_back(all.back());
      all.back().view = View::unknown;
      all.back().slice_order = SliceOrder::unknown;
      all.back().time_ms.clear();
      all.back().cycle_ms = 0;
    }
  return all;
}

TEST(DicomWriter, IsCleanInDciodvfy) {
  if (!is_installed("dciodvfy")) GTEST_SKIP() << "dciodvfy (package dicom3tools) is not installed";
  const test::ScratchFolder scratch;
  for (const Study& study : studies()) {
    write_dicom(study, scratch / "a.dcm");
    std::istringstream lines(output_of("dciodvfy " + (scratch / "a.dcm").string()));
    for (std::string line; std::getline(lines, line);) {
      // dciodvfy looks for FrameIncrementPointer within the item, where it never is; the standard wants the sequence.
      const bool false_alarm = line.find("TimeSlotInformationSequence") != std::string::npos &&
                               line.find("when condition unsatisfied") != std::string::npos;
      EXPECT_TRUE(line == "NMImage" || false_alarm) << line;
    }
  }
}

TEST(DicomWriter, IsReadByPydicomWithTheSameValuesAndPlace) {
  const std::string python = "/usr/bin/python3";
  if (std::system((python + " -c 'import pydicom, numpy' 2> /dev/null").c_str()) != 0)
    GTEST_SKIP() << "python3-pydicom and python3-numpy are not installed";
  const test::ScratchFolder scratch;
  const Study study = test::l_shape_study(test::oblique_grid(true), 3);
  write_dicom(study, scratch / "a.dcm");
  test::write_bytes(scratch / "ask.py", R"(
import sys, pydicom, numpy as np
d = pydicom.dcmread(sys.argv[1])
a = d.pixel_array
det = d.DetectorInformationSequence[0]
r, c = np.array(det.ImageOrientationPatient[:3], float), np.array(det.ImageOrientationPatient[3:], float)
p = np.array(det.ImagePositionPatient, float) + 6 * r * d.PixelSpacing[1] + 2 * c * d.PixelSpacing[0] \
    + 4 * np.cross(r, c) * float(d.SpacingBetweenSlices)
print(a.shape, a[1 * 5 + 4, 2, 6], int(a.sum()), d.file_meta.TransferSyntaxUID.name, d.ImageType[2])
print(*['%.6f' % x for x in p])
)");
  const Vec3 corner = to_world(study.grid(), centre_of(study.grid(), {6, 2, 4}));
  long sum = 0;
  for (const Image& gate : study.gates)
    for (const float v : gate.values) sum += static_cast<long>(v);
  char expected[300];
  std::snprintf(expected, sizeof expected,
                "(15, 6, 7) %d %ld Explicit VR Little Endian RECON GATED TOMO\n%.6f %.6f %.6f\n",
                static_cast<int>(study.gates[1](6, 2, 4)), sum, corner[0], corner[1], corner[2]);
  EXPECT_EQ(output_of(python + " " + (scratch / "ask.py").string() + " " + (scratch / "a.dcm").string()), expected);
}

TEST(NiftiWriter, IsReadByNibabelAtTheSamePlace) {
  const std::string python = "/usr/bin/python3";
  if (std::system((python + " -c 'import nibabel' 2> /dev/null").c_str()) != 0)
    GTEST_SKIP() << "python3-nibabel is not installed";
  const test::ScratchFolder scratch;
  for (const bool left_handed : {false, true}) {
    const Study study = test::l_shape_study(test::oblique_grid(left_handed), 3);
    write_nifti(study, scratch / "a.nii.gz");
    test::write_bytes(scratch / "ask.py", R"(
import sys, nibabel, numpy as np
n = nibabel.load(sys.argv[1])
print(n.shape, n.get_fdata()[6, 2, 4, 1], n.header.get_xyzt_units(), bool(np.allclose(n.get_sform(), n.get_qform(), atol=1e-4)))
p = n.affine @ [6, 2, 4, 1]
print('%.3f %.3f %.3f' % (-p[0], -p[1], p[2]))
)");
    const Vec3 corner = to_world(study.grid(), centre_of(study.grid(), {6, 2, 4}));
    char expected[300];
    std::snprintf(expected, sizeof expected, "(7, 6, 5, 3) %.1f ('mm', 'msec') True\n%.3f %.3f %.3f\n",
                  double(study.gates[1](6, 2, 4)), corner[0], corner[1], corner[2]);
    EXPECT_EQ(output_of(python + " " + (scratch / "ask.py").string() + " " + (scratch / "a.nii.gz").string()),
              expected);
  }
}

}  // namespace
}  // namespace dynasurf::io
