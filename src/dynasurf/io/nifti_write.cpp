#include <cmath>
#include <cstring>
#include <string>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/gzip.hpp"
#include "dynasurf/io/detail/label_io.hpp"
#include "dynasurf/io/detail/nifti_format.hpp"
#include "dynasurf/io/study_io.hpp"

namespace dynasurf::io {
namespace {

template <class T>
void put(std::string& bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof(T));
}
void put_real(std::string& bytes, std::size_t offset, double value) { put(bytes, offset, static_cast<float>(value)); }
void put_small(std::string& bytes, std::size_t offset, int value) {
  put(bytes, offset, static_cast<std::int16_t>(value));
}

double gate_step_ms(const Study& study) {
  if (study.cycle_ms > 0) return study.cycle_ms / study.gates.size();
  return study.time_ms.size() > 1 ? study.time_ms[1] - study.time_ms[0] : 0;
}

/// How the numbers are stored, and what they are.
struct Stored {
  int type, bits, intent;
};

/// The header of a study's volumes, with the place where they begin.
std::string header_of(const Study& study, const Stored& stored, const std::filesystem::path& path) {
  if (study.gates.empty()) throw InputError(path.string() + ": cannot write a study without a volume");
  const Grid& grid = study.grid();
  for (const int extent : grid.dims)
    if (extent > 32767) throw InputError(path.string() + ": NIfTI-1 holds at most 32767 voxels along an axis");

  std::string bytes(nifti::header_bytes + 4, '\0');
  put(bytes, 0, static_cast<std::int32_t>(nifti::header_bytes));
  const int gates = study.gates.size();
  const int dims[8] = {gates > 1 ? 4 : 3, grid.dims[0], grid.dims[1], grid.dims[2], gates, 1, 1, 1};
  for (std::size_t d = 0; d < 8; ++d) put_small(bytes, nifti::dim + 2 * d, dims[d]);
  put_small(bytes, nifti::intent_code, stored.intent);
  put_small(bytes, nifti::datatype, stored.type);
  put_small(bytes, nifti::bitpix, stored.bits);

  const Vec3 to_ras(-1, -1, 1);
  Mat3 rotation = to_ras.asDiagonal() * grid.direction;
  const Vec3 origin = to_ras.asDiagonal() * grid.origin;
  const bool left_handed = rotation.determinant() < 0;
  const double pixdim[8] = {
      left_handed ? -1.0 : 1.0, grid.spacing[0], grid.spacing[1], grid.spacing[2], gate_step_ms(study), 1, 1, 1};
  for (std::size_t d = 0; d < 8; ++d) put_real(bytes, nifti::pixdim + 4 * d, pixdim[d]);
  put_real(bytes, nifti::vox_offset, bytes.size());
  put_real(bytes, nifti::scl_slope, 1);
  bytes[nifti::xyzt_units] = static_cast<char>(nifti::unit_millimetre | nifti::unit_millisecond);
  if (!study.time_ms.empty()) put_real(bytes, nifti::toffset, study.time_ms.front());
  // NIfTI has no place for how the slices cut the heart; the free text of 80 bytes carries it to our own reader.
  const std::string note =
      "dynasurf " + std::string(name_of(study.view)) + " " + std::string(name_of(study.slice_order));
  std::memcpy(bytes.data() + nifti::descrip, note.data(), note.size());

  put_small(bytes, nifti::sform_code, 1);  // scanner coordinates
  put_small(bytes, nifti::qform_code, 1);
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col)
      put_real(bytes, nifti::srow + 4 * static_cast<std::size_t>(4 * row + col),
               rotation(row, col) * grid.spacing[col]);
    put_real(bytes, nifti::srow + 4 * static_cast<std::size_t>(4 * row + 3), origin[row]);
    put_real(bytes, nifti::qoffset + 4 * static_cast<std::size_t>(row), origin[row]);
  }
  // A quaternion holds rotations only: the mirror of a left-handed grid goes into pixdim[0].
  if (left_handed) rotation.col(2) = -rotation.col(2);
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  put_real(bytes, nifti::quatern, q.x());
  put_real(bytes, nifti::quatern + 4, q.y());
  put_real(bytes, nifti::quatern + 8, q.z());
  std::memcpy(bytes.data() + nifti::magic, "n+1", 4);
  return bytes;
}

template <class T>
void write_volumes(std::string bytes, std::span<const Volume<T>> gates, const std::filesystem::path& path) {
  for (const Volume<T>& gate : gates)
    bytes.append(reinterpret_cast<const char*>(gate.values.data()), gate.values.size() * sizeof(T));
  write_file(path, path.extension() == ".gz" ? gzip(bytes) : bytes);
}

}  // namespace

void write_nifti(const Study& study, const std::filesystem::path& path) {
  write_volumes<float>(header_of(study, {nifti::type_float32, 32, 0}, path), study.gates, path);
}

void write_label_nifti(std::span<const Mask> gates, const Study& frame, const std::filesystem::path& path) {
  if (gates.size() != frame.gates.size())
    throw InputError(path.string() + ": " + std::to_string(gates.size()) + " volumes of labels; expected " +
                     std::to_string(frame.gates.size()) + ", one per gate");
  write_volumes<std::uint8_t>(header_of(frame, {nifti::type_uint8, 8, nifti::intent_label}, path), gates, path);
}

}  // namespace dynasurf::io
