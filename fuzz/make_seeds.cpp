// What the fuzzer starts from: small files of every format, made by the program's own writers, and by hand where it
// has none. fuzz_seeds FOLDER writes FOLDER/<target>/seed-<n>.bin. Nothing comes from anybody's files.

#include <cstdio>
#include <cstring>
#include <set>

#include "dynasurf/io/detail/nifti_format.hpp"
#include "dynasurf/io/study_io.hpp"

#include "seeds.hpp"
#include "support/dicom_edit.hpp"
#include "support/l_shape.hpp"
#include "support/scratch_folder.hpp"

namespace dynasurf::fuzz {
namespace {

namespace fs = std::filesystem;
using test::read_bytes;

Study small_study(int gates, Index3 dims = {3, 2, 2}) {
  Grid grid = test::oblique_grid();
  grid.dims = dims;
  return test::l_shape_study(grid, gates);
}

std::string as_dicom(const Study& study, const std::function<void(DcmDataset&)>& change,
                     E_TransferSyntax syntax = EXS_LittleEndianExplicit, E_FileWriteMode mode = EWM_fileformat) {
  const test::ScratchFolder scratch;
  io::write_dicom(study, scratch / "plain.dcm");
  test::edit_dicom(scratch / "plain.dcm", scratch / "changed.dcm", change, syntax, mode);
  return read_bytes(scratch / "changed.dcm");
}

void write_dicom_seeds(const fs::path& all) {
  SeedFolder seeds(all, "dicom");
  const auto as_it_is = [](DcmDataset&) {};
  for (const int gates : {1, 3})
    for (const E_TransferSyntax syntax :
         {EXS_LittleEndianExplicit, EXS_LittleEndianImplicit, EXS_BigEndianExplicit, EXS_RLELossless})
      seeds.add(as_dicom(small_study(gates), as_it_is, syntax));
  seeds.add(as_dicom(small_study(2), as_it_is, EXS_LittleEndianImplicit, EWM_dataset));
  seeds.add(as_dicom(small_study(2), as_it_is, EXS_BigEndianExplicit, EWM_dataset));
  seeds.add(as_dicom(small_study(1), [](DcmDataset& d) {
    test::put(d, DCM_RescaleSlope, "0.5");
    test::put(d, DCM_RescaleIntercept, "-3");
    test::put(d, DCM_SliceLocation, "7");
    test::put(d, DCM_TriggerTime, "120");
  }));
  seeds.add(as_dicom(small_study(1), [](DcmDataset& d) {
    DcmItem& mapping = test::item_of(d, DCM_RealWorldValueMappingSequence);
    test::put(mapping, DCM_RealWorldValueLastValueMapped, std::vector<Uint16>{9});
    DcmItem& tracer = test::item_of(d, DCM_RadiopharmaceuticalInformationSequence);
    test::put(tracer, DCM_Radiopharmaceutical, "Sestamibi");
    test::put(test::item_of(tracer, DCM_RadionuclideCodeSequence), DCM_CodeMeaning, "^99m^Technetium");
    test::put(d, DCM_CorrectedImage, "ATTN\\SCAT");
    test::put(d, DCM_SeriesDescription, "SA gate 3");
  }));
}

std::string joined(const fs::path& folder) {
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.insert(entry.path());
  std::string out;
  for (const fs::path& file : files) out += (out.empty() ? "" : "--CUT--") + read_bytes(file);
  return out;
}

void write_dicom_folder_seeds(const fs::path& all) {
  using Tell = std::function<void(DcmDataset&, int)>;
  SeedFolder seeds(all, "dicom_folder");
  const Tell tells[] = {[](DcmDataset&, int) {},
                        [](DcmDataset& d, int gate) { test::put(d, DCM_TriggerTime, std::to_string(100 * gate)); },
                        [](DcmDataset& d, int gate) {
                          test::put(d, DCM_TemporalPositionIdentifier, std::to_string(gate + 1));
                          test::put(d, DCM_NominalInterval, "800");
                        },
                        [](DcmDataset& d, int gate) {
                          test::put(d, DCM_SeriesDescription, "SA gate " + std::to_string(gate + 1));
                          test::put(d, DCM_SeriesInstanceUID, "2.25." + std::to_string(gate + 1));
                        }};
  for (const Tell& tell : tells) {
    const test::ScratchFolder scratch;
    test::write_single_frames(small_study(&tell == &tells[0] ? 1 : 2, {2, 2, 3}), scratch / "slices", tell);
    seeds.add(joined(scratch / "slices"));
  }
  const test::ScratchFolder scratch;
  for (const char* name : {"a", "b"}) test::write_bytes(scratch / name, as_dicom(small_study(1), [](DcmDataset&) {}));
  seeds.add(joined(scratch.path()));
}

template <class T>
void set(std::string& bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof(T));
}

std::string as_nifti(const Study& study, int type, int bits, std::size_t bytes_per_voxel) {
  const test::ScratchFolder scratch;
  io::write_nifti(study, scratch / "a.nii");
  std::string bytes = read_bytes(scratch / "a.nii");
  set(bytes, io::nifti::datatype, static_cast<std::int16_t>(type));
  set(bytes, io::nifti::bitpix, static_cast<std::int16_t>(bits));
  bytes.resize(352);
  bytes.append(study.gates.size() * study.grid().size() * bytes_per_voxel, '\1');
  return bytes;
}

void write_nifti_seeds(const fs::path& all) {
  const test::ScratchFolder scratch;
  SeedFolder single(all, "nifti"), packed(all, "nifti_gz"), pair(all, "nifti_pair");
  const std::pair<int, int> types[] = {{2, 8}, {256, 8}, {512, 16}, {4, 16}, {768, 32}, {8, 32}, {16, 32}, {64, 64}};
  for (const auto& [type, bits] : types) {
    std::string bytes = as_nifti(small_study(2), type, bits, static_cast<std::size_t>(bits) / 8);
    single.add(bytes);
    set(bytes, io::nifti::sform_code, std::int16_t{0});
    single.add(bytes);
    set(bytes, io::nifti::qform_code, std::int16_t{0});
    set(bytes, io::nifti::scl_slope, 0.5F);
    packed.add(bytes);
    set(bytes, io::nifti::vox_offset, 0.0F);
    set(bytes, io::nifti::magic, std::array<char, 4>{'n', 'i', '1', 0});
    bytes.erase(348, 4);
    pair.add(bytes);
  }
  io::write_nifti(small_study(2), scratch / "a.nii.gz");
  packed.add(read_bytes(scratch / "a.nii.gz"));
}

void write_nrrd_seeds(const fs::path& all) {
  const test::ScratchFolder scratch;
  SeedFolder attached(all, "nrrd"), detached(all, "nhdr");
  for (const int gates : {1, 2}) {
    io::write_nrrd(small_study(gates), scratch / "a.nrrd");
    attached.add(read_bytes(scratch / "a.nrrd"));
  }
  const std::string sizes[] = {"dimension: 3\nsizes: 2 1 2\n", "dimension: 4\nsizes: 2 1 2 1\n"};
  const std::string places[] = {
      "space: left-posterior-superior\nspace directions: (2,0,0) (0,2,0) (0,0,3)\nspace origin: (1,-2,3)\n"
      "space units: \"mm\" \"mm\" \"mm\"\n",
      "spacings: 2 2 3 1\nkinds: domain domain domain list\nunits: \"mm\" \"mm\" \"mm\" \"ms\"\n"
      "axis 3 index values:=0 100\ndynasurf view:=short axis\ndynasurf cycle ms:=800\n"};
  for (int rank = 0; rank < 2; ++rank)
    for (const char* type : {"uchar", "int16", "uint32", "int64", "float", "double"})
      for (const char* packing : {"raw", "gzip"}) {
        const std::size_t bytes = std::strcmp(type, "uchar") == 0   ? 1
                                  : type[3] == '1'                  ? 2
                                  : type[0] == 'd'                  ? 8
                                  : std::strcmp(type, "int64") == 0 ? 8
                                                                    : 4;
        const std::string header = "NRRD0005\n# by hand\ntype: " + std::string(type) + "\n" + sizes[rank] +
                                   "endian: " + (bytes == 2 ? "big" : "little") + "\nencoding: " + packing + "\n" +
                                   places[rank];
        attached.add(header + "\n" + std::string(4 * bytes, '\1'));
        detached.add(header + "data file: a.raw\n" + (bytes == 4 ? "byte skip: -1\n" : "line skip: 0\n") + "\n----\n" +
                     std::string(4 * bytes, '\1'));
      }
}

}  // namespace
}  // namespace dynasurf::fuzz

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: fuzz_seeds FOLDER\n");
    return 2;
  }
  const std::filesystem::path all = argv[1];
  using namespace dynasurf::fuzz;
  write_dicom_seeds(all);
  write_dicom_folder_seeds(all);
  write_nifti_seeds(all);
  write_nrrd_seeds(all);
  write_mesh_seeds(all);
  write_text_seeds(all);
  write_manifest_seeds(all);
  write_option_seeds(all);
  return 0;
}
