#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/formats.hpp"
#include "dynasurf/io/detail/nifti_format.hpp"
#include "dynasurf/io/detail/samples.hpp"

namespace dynasurf::io {
namespace {

namespace fs = std::filesystem;

// What stands before the voxels is the header and extensions of some kilobytes; a gzip file has to be unpacked up to
// there.
constexpr double most_offset = 1 << 24;

struct Header {
  std::array<std::byte, nifti::header_bytes> bytes;
  bool big_endian = false;

  template <class T>
  T at(std::size_t offset) const {
    std::array<std::byte, sizeof(T)> raw;
    std::copy_n(bytes.begin() + offset, sizeof(T), raw.begin());
    if (big_endian) std::reverse(raw.begin(), raw.end());
    T value;
    std::memcpy(&value, raw.data(), sizeof(T));
    return value;
  }
  double real(std::size_t offset, std::size_t n = 0) const { return at<float>(offset + 4 * n); }
  int small(std::size_t offset, std::size_t n = 0) const { return at<std::int16_t>(offset + 2 * n); }
  bool has_magic(const char* text) const { return std::memcmp(bytes.data() + nifti::magic, text, 4) == 0; }
};

ByteSource open_source(const fs::path& path) {
  return ByteSource(path, is_gzip_file(path) ? ByteSource::Packing::gzip : ByteSource::Packing::plain);
}

Header read_header(ByteSource& source, const std::string& where) {
  Header header;
  source.read(header.bytes, "header");
  // Read in the machine's order first; a size that is not 348 is read the other way around.
  header.big_endian = header.at<std::int32_t>(0) != static_cast<std::int32_t>(nifti::header_bytes);
  if (header.at<std::int32_t>(0) != static_cast<std::int32_t>(nifti::header_bytes))
    throw InputError(where + ": is not a NIfTI-1 file: its header does not start with 348");
  if (!header.has_magic("n+1") && !header.has_magic("ni1"))
    throw InputError(where +
                     ": is an Analyze 7.5 file or a damaged NIfTI file (no \"n+1\" at byte 344); it does not say " +
                     "which side is left, so convert it to NIfTI or DICOM first");
  return header;
}

SampleType sample_type(const Header& header, const std::string& where) {
  struct Known {
    int code, bits;
    SampleType type;
  };
  constexpr Known known[] = {{2, 8, SampleType::uint8},     {256, 8, SampleType::int8},
                             {512, 16, SampleType::uint16}, {4, 16, SampleType::int16},
                             {768, 32, SampleType::uint32}, {8, 32, SampleType::int32},
                             {16, 32, SampleType::float32}, {64, 64, SampleType::float64}};
  const int code = header.small(nifti::datatype);
  for (const Known& k : known) {
    if (k.code != code) continue;
    if (header.small(nifti::bitpix) != k.bits)
      throw InputError(where + ": says " + std::to_string(header.small(nifti::bitpix)) +
                       " bits per voxel, but its type " + std::to_string(code) + " has " + std::to_string(k.bits));
    return k.type;
  }
  throw InputError(where + ": NIfTI data type " + std::to_string(code) +
                   " is not read; expected 8, 16 or 32 bit integers or 32 or 64 bit real numbers");
}

struct Extents {
  Index3 dims{};
  int gates = 1;
};

Extents extents_of(const Header& header, const std::string& where) {
  const int rank = header.small(nifti::dim);
  if (rank < 3 || rank > 7)
    throw InputError(where + ": has " + std::to_string(rank) + " dimensions; expected 3 (one volume) or 4 (gates)");
  Extents e;
  for (int d = 1; d <= rank; ++d) {
    const int extent = header.small(nifti::dim, d);
    if (extent < 1)
      throw InputError(where + ": extent of dimension " + std::to_string(d) + " is " + std::to_string(extent) +
                       "; expected at least 1");
    if (d <= 3)
      e.dims[static_cast<std::size_t>(d) - 1] = extent;
    else if (d == 4)
      e.gates = extent;
    else if (extent != 1)
      throw InputError(where + ": dimension " + std::to_string(d) + " has " + std::to_string(extent) +
                       " entries; expected one value per voxel and gate");
  }
  check_study_size(e.dims[0], e.dims[1], e.dims[2], e.gates, where);
  return e;
}

/// Columns 0..2: RAS steps along i, j, k; column 3: RAS position of voxel (0,0,0). In the file's units.
using Affine = Eigen::Matrix<double, 3, 4>;

Affine affine_of_sform(const Header& header) {
  Affine a;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t col = 0; col < 4; ++col) a(row, col) = header.real(nifti::srow, row * 4 + col);
  return a;
}

/// Sizes of a voxel by the header's word; only a sform makes do without them. A sign would say that an axis runs back,
/// but pixdim must not tell that, and readers differ.
Vec3 voxel_sizes(const Header& header, const std::string& where) {
  Vec3 sizes;
  for (int axis = 0; axis < 3; ++axis) {
    sizes[axis] = header.real(nifti::pixdim, static_cast<std::size_t>(axis) + 1);
    if (!(sizes[axis] > 0))
      throw InputError(where + ": pixdim[" + std::to_string(axis + 1) + "] is " + std::to_string(sizes[axis]) +
                       "; expected the size of a voxel, above 0");
  }
  return sizes;
}

Affine affine_of_qform(const Header& header, const std::string& where) {
  const double b = header.real(nifti::quatern), c = header.real(nifti::quatern, 1), d = header.real(nifti::quatern, 2);
  const double rest = 1 - (b * b + c * c + d * d);
  if (!(rest > -1e-5)) throw InputError(where + ": the quaternion of its qform is longer than 1");
  // The real part of a unit quaternion is not stored: NIfTI has it never below 0.
  const Eigen::Quaterniond q(std::sqrt(std::max(rest, 0.0)), b, c, d);
  // pixdim[0], qfac: -1 turns the third axis around, which no rotation can.
  const double handedness = header.real(nifti::pixdim) < 0 ? -1 : 1;
  Affine a;
  a.leftCols<3>() =
      q.normalized().toRotationMatrix() * voxel_sizes(header, where).cwiseProduct(Vec3(1, 1, handedness)).asDiagonal();
  for (int row = 0; row < 3; ++row) a(row, 3) = header.real(nifti::qoffset, row);
  return a;
}

double millimetres_per_unit(const Header& header, const std::string& where) {
  const int unit = std::to_integer<int>(header.bytes[nifti::xyzt_units]) & 7;
  switch (unit) {
    case 0:  // not said: NIfTI's default is mm
    case nifti::unit_millimetre:
      return 1;
    case nifti::unit_metre:
      return 1000;
    case nifti::unit_micrometre:
      return 0.001;
    default:
      throw InputError(where + ": unknown unit of length " + std::to_string(unit) + " in xyzt_units");
  }
}

Grid grid_of(const Header& header, const Index3& dims, Notes& notes, const std::string& where) {
  Affine ras = Affine::Zero();
  if (header.small(nifti::sform_code) > 0) {
    ras = affine_of_sform(header);
  } else if (header.small(nifti::qform_code) > 0) {
    ras = affine_of_qform(header, where);
  } else {
    ras.leftCols<3>() = voxel_sizes(header, where).asDiagonal();
    notes.push_back({Severity::warning, "nifti.no_orientation",
                     "the file has neither sform nor qform: where left and right are is assumed, not known"});
  }
  ras *= millimetres_per_unit(header, where);
  const Vec3 to_lps(-1, -1, 1);  // NIfTI counts towards right, anterior, superior
  return grid_from_steps(dims, to_lps.asDiagonal() * ras.leftCols<3>(), to_lps.asDiagonal() * ras.col(3), where);
}

void set_times(Study& study, const Header& header) {
  const int unit = std::to_integer<int>(header.bytes[nifti::xyzt_units]) & 0x38;
  const double ms = unit == nifti::unit_second        ? 1000
                    : unit == nifti::unit_millisecond ? 1
                    : unit == nifti::unit_microsecond ? 0.001
                                                      : 0;
  if (study.gates.size() < 2) return;
  set_uniform_times(study, header.real(nifti::toffset) * ms, header.real(nifti::pixdim, 4) * ms, "nifti.no_gate_times");
}

/// View and slice order from the description that our own writer leaves.
void set_view(Study& study, const Header& header) {
  const auto* text = reinterpret_cast<const char*>(header.bytes.data()) + nifti::descrip;
  const std::string note(text, ::strnlen(text, 80));
  for (const View v : {View::short_axis, View::horizontal_long_axis, View::vertical_long_axis, View::transaxial})
    for (const SliceOrder o : {SliceOrder::unknown, SliceOrder::apex_to_base, SliceOrder::base_to_apex})
      if (note == "dynasurf " + std::string(name_of(v)) + " " + std::string(name_of(o))) {
        study.view = v;
        study.slice_order = o;
      }
}

/// The file beside a header of a pair that holds its voxels.
fs::path image_file_of(const fs::path& header_path) {
  fs::path stem = header_path;
  if (stem.extension() == ".gz") stem.replace_extension();
  if (stem.extension() != ".hdr")
    throw InputError(header_path.string() + ": is the header of a pair, but its name does not end in .hdr");
  for (const char* ending : {".img", ".img.gz"}) {
    fs::path image = stem;
    image.replace_extension(ending);
    std::error_code ignored;
    if (fs::exists(image, ignored)) return image;
  }
  throw InputError(header_path.string() + ": is the header of a pair; its .img file is not beside it");
}

}  // namespace

void set_uniform_times(Study& study, double first_ms, double step_ms, const std::string& code) {
  const double cycle = step_ms * study.gates.size();
  // 20 to 300 beats a minute; a step of "1" that nobody filled in falls outside.
  if (!(cycle >= 200 && cycle <= 3000) || !(std::abs(first_ms) <= cycle)) {
    study.notes.push_back({Severity::info, code, "the times of the gates are not in the file or make no heart beat"});
    return;
  }
  study.cycle_ms = cycle;
  for (std::size_t g = 0; g < study.gates.size(); ++g) study.time_ms.push_back(first_ms + g * step_ms);
}

std::vector<std::filesystem::path> data_files_of_nifti(const std::filesystem::path& path) {
  ByteSource source = open_source(path);
  if (read_header(source, path.string()).has_magic("n+1")) return {};
  return {image_file_of(path)};
}

Study read_nifti(const std::filesystem::path& path) {
  const std::string where = path.string();
  ByteSource source = open_source(path);
  const Header header = read_header(source, where);
  const Extents extents = extents_of(header, where);

  SampleLayout layout;
  layout.type = sample_type(header, where);
  layout.big_endian = header.big_endian;
  const double slope = header.real(nifti::scl_slope), intercept = header.real(nifti::scl_inter);
  // Zero, or not a number, means that the values are not scaled.
  if (slope != 0 && std::isfinite(slope)) {
    layout.slope = slope;
    if (!std::isfinite(intercept)) throw InputError(where + ": scl_inter is not a finite number");
    layout.intercept = intercept;
  }

  Study study;
  study.format = "NIfTI";
  const Grid grid = grid_of(header, extents.dims, study.notes, where);
  const double offset = header.real(nifti::vox_offset);
  const bool single = header.has_magic("n+1");
  const double least = single ? nifti::header_bytes + 4 : 0;
  if (!(offset >= least) || offset != std::floor(offset) || offset > most_offset) {
    // Writers of pairs leave it at zero; for a single file zero is known to mean the usual place.
    if (!(single && offset == 0))
      throw InputError(where + ": vox_offset is " + std::to_string(offset) + "; expected a whole number from " +
                       std::to_string(static_cast<int>(least)) + " to " +
                       std::to_string(static_cast<int>(most_offset)));
  }
  const auto start = static_cast<std::uint64_t>(std::max(offset, least));
  if (single) {
    source.skip(start - nifti::header_bytes, "header extension");
    study.gates = read_samples(source, grid, extents.gates, layout, where, study.notes);
  } else {
    const fs::path image = image_file_of(path);
    ByteSource voxels = open_source(image);
    voxels.skip(start, "bytes before the voxels");
    study.gates = read_samples(voxels, grid, extents.gates, layout, image.string(), study.notes);
  }
  set_times(study, header);
  set_view(study, header);
  return study;
}

}  // namespace dynasurf::io
