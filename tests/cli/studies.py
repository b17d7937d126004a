"""Files of studies, byte by byte."""

import struct


def explicit_elements(data):
    """The elements of an explicit little-endian DICOM file up to the first one of undefined length, and the rest."""
    elements, position = {}, 132
    while position < len(data):
        group, element = struct.unpack_from("<HH", data, position)
        long = data[position + 4:position + 6] in (b"OB", b"OW", b"OF", b"SQ", b"UT", b"UN", b"UC", b"UR", b"OD", b"OL")
        length = struct.unpack_from("<I" if long else "<H", data, position + (8 if long else 6))[0]
        if length == 0xFFFFFFFF:
            break
        end = position + (12 if long else 8) + length
        elements[group, element] = data[position:end]
        position = end
    return elements, data[position:]


def with_elements(data, changes):
    """The DICOM file with elements (tag -> (VR, text)) replaced or added."""
    elements, rest = explicit_elements(data)
    following = struct.unpack_from("<HH", rest) if rest else (0xFFFF, 0xFFFF)
    for tag, (vr, text) in changes.items():
        assert tag < following, tag
        value = text.encode() + b" " * (len(text) % 2)
        elements[tag] = struct.pack("<HH2sH", *tag, vr.encode(), len(value)) + value
    return data[:132] + b"".join(elements[tag] for tag in sorted(elements)) + rest


def empty_study(path, shape=(24, 24, 8, 4)):
    """A NIfTI file of zeros."""
    header = bytearray(348)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 4, *shape, 1, 1, 1)
    struct.pack_into("<hh", header, 70, 16, 32)
    struct.pack_into("<8f", header, 76, 1, 3, 3, 6, 50, 1, 1, 1)
    struct.pack_into("<f", header, 108, 352)
    header[123] = 2 | 16  # mm, ms
    header[344:348] = b"n+1\0"
    path.write_bytes(bytes(header) + bytes(4) + bytes(4 * shape[0] * shape[1] * shape[2] * shape[3]))
