#pragma once
#include <cstddef>

namespace dynasurf::io::nifti {

// Byte offsets of the NIfTI-1 header fields in use, from the published header file nifti1.h.
inline constexpr std::size_t header_bytes = 348;
inline constexpr std::size_t dim = 40, intent_code = 68, datatype = 70, bitpix = 72, pixdim = 76, vox_offset = 108,
                             scl_slope = 112, scl_inter = 116, xyzt_units = 123, toffset = 136, descrip = 148,
                             qform_code = 252, sform_code = 254, quatern = 256, qoffset = 268, srow = 280, magic = 344;

inline constexpr int unit_metre = 1, unit_millimetre = 2, unit_micrometre = 3;
inline constexpr int unit_second = 8, unit_millisecond = 16, unit_microsecond = 24;
inline constexpr int type_uint8 = 2, type_float32 = 16, intent_label = 1002;

}  // namespace dynasurf::io::nifti
