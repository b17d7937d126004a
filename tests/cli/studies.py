"""Files of studies, byte by byte."""

import struct


LONG_KINDS = (b"OB", b"OW", b"OF", b"SQ", b"UT", b"UN", b"UC", b"UR", b"OD", b"OL")  # of four bytes for the length


def explicit_elements(data):
    """The elements of an explicit little-endian DICOM file up to the first one of undefined length, and the rest."""
    elements, position = {}, 132
    while position < len(data):
        group, element = struct.unpack_from("<HH", data, position)
        long = data[position + 4:position + 6] in LONG_KINDS
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


def with_implicit_kinds(data):
    """The explicit little-endian DICOM file in implicit little endian, whose readers must know every element's kind."""
    undefined, item_end, sequence_end = 0xFFFFFFFF, (0xFFFE, 0xE00D), (0xFFFE, 0xE0DD)

    def header(tag, length):
        return struct.pack("<HHI", *tag, length)

    def elements(position, end):
        out = b""
        while position < end:
            tag = struct.unpack_from("<HH", data, position)
            if tag == item_end:
                return out, position + 8
            kind = data[position + 4:position + 6]
            long = kind in LONG_KINDS
            length = struct.unpack_from("<I" if long else "<H", data, position + (8 if long else 6))[0]
            position += 12 if long else 8
            if kind == b"SQ":
                inner, position = items(position, len(data) if length == undefined else position + length)
                out += header(tag, undefined) + inner + header(sequence_end, 0)
            else:
                out += header(tag, length) + data[position:position + length]
                position += length
        return out, position

    def items(position, end):
        out = b""
        while position < end:
            *tag, length = struct.unpack_from("<HHI", data, position)
            position += 8
            if tuple(tag) == sequence_end:
                break
            inner, position = elements(position, len(data) if length == undefined else position + length)
            out += header(tag, undefined) + inner + header(item_end, 0)
        return out, position

    first = 132 + 12 + struct.unpack_from("<I", data, 140)[0]  # behind the file's own elements, which stay explicit
    meta = {tag: element for tag, element in explicit_elements(data[:first])[0].items() if tag != (0x0002, 0x0000)}
    meta[0x0002, 0x0010] = struct.pack("<HH2sH", 0x0002, 0x0010, b"UI", 18) + b"1.2.840.10008.1.2\0"
    meta = b"".join(meta[tag] for tag in sorted(meta))
    return (data[:132] + struct.pack("<HH2sHI", 0x0002, 0x0000, b"UL", 4, len(meta)) + meta
            + elements(first, len(data))[0])


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
