"""The binary resists mistakes of its own readers: what the compiler and the linker were asked for is really in it."""

import os
import platform
import struct
import unittest

PROGRAM = os.environ["DYNASURF_PROGRAM"]

# Names of ELF (System V ABI and its GNU supplement).
ET_DYN = 3
PT_DYNAMIC, PT_INTERP, PT_GNU_STACK, PT_GNU_RELRO = 2, 3, 0x6474E551, 0x6474E552
DT_NEEDED, DT_RPATH, DT_RUNPATH, DT_FLAGS, DT_FLAGS_1 = 1, 15, 29, 30, 0x6FFFFFFB
DF_BIND_NOW, DF_1_NOW, DF_1_PIE = 8, 1, 0x08000000
SHT_SYMTAB, SHT_DYNSYM = 2, 11
STT_FUNC = 2
ENDBR64 = b"\xf3\x0f\x1e\xfa"


class Elf:
    """A little-endian 64-bit ELF file: segments, dynamic entries, symbols."""

    def __init__(self, path):
        with open(path, "rb") as file:
            self.data = file.read()
        assert self.data[:6] == b"\x7fELF\x02\x01"
        self.type, = struct.unpack_from("<H", self.data, 16)
        segments_at, sections_at = struct.unpack_from("<QQ", self.data, 32)
        segment_size, segments, section_size, sections, _ = struct.unpack_from("<5H", self.data, 54)
        # type, flags, offset, address, physical address, size in file
        self.segments = [struct.unpack_from("<IIQQQQ", self.data, segments_at + n * segment_size) for n in range(segments)]
        # name, type, flags, address, offset, size, link, info
        self.sections = [struct.unpack_from("<IIQQQQII", self.data, sections_at + n * section_size)
                         for n in range(sections)]
        self.dynamic = [entry for _, _, at, _, _, size in self.of_type(PT_DYNAMIC)
                        for entry in struct.iter_unpack("<qQ", self.data[at:at + size])]

    def of_type(self, kind):
        return [segment for segment in self.segments if segment[0] == kind]

    def flag(self, tag):
        return next((value for found, value in self.dynamic if found == tag), 0)

    def text_at(self, at):
        return self.data[at:self.data.index(b"\0", at)].decode()

    def symbols(self, kind):
        """(name, whether it is a function, section, address) of the table of that kind."""
        for _, found, _, _, at, size, link, _ in self.sections:
            if found != kind:
                continue
            names_at = self.sections[link][4]
            for name, info, _, section, address, _ in struct.iter_unpack("<IBBHQQ", self.data[at:at + size]):
                yield self.text_at(names_at + name), info & 15 == STT_FUNC, section, address

    def bytes_at(self, address, count):
        for kind, _, offset, start, _, size in self.segments:
            if kind == 1 and start <= address < start + size:
                return self.data[offset + address - start:offset + address - start + count]
        return b""


def is_sanitized(elf):
    return any(name.startswith(("__asan_", "__tsan_", "__ubsan_")) for name, *_ in elf.symbols(SHT_DYNSYM))


class Hardening(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.elf = Elf(PROGRAM)
        if is_sanitized(cls.elf):
            raise unittest.SkipTest("sanitizers bring their own checks")
        cls.imported = {name for name, _, section, _ in cls.elf.symbols(SHT_DYNSYM) if section == 0}

    def test_it_lies_anywhere_in_memory(self):
        self.assertEqual(self.elf.type, ET_DYN)
        self.assertTrue(self.elf.of_type(PT_INTERP), "a program, not a library")
        self.assertTrue(self.elf.flag(DT_FLAGS_1) & DF_1_PIE)

    def test_no_memory_is_both_written_and_run(self):
        stack, = self.elf.of_type(PT_GNU_STACK)
        self.assertEqual(stack[1] & 1, 0)
        for segment in self.elf.of_type(1):
            self.assertNotEqual(segment[1] & 3, 3)

    def test_addresses_of_libraries_are_fixed_before_it_runs(self):
        self.assertTrue(self.elf.of_type(PT_GNU_RELRO))
        self.assertTrue(self.elf.flag(DT_FLAGS) & DF_BIND_NOW or self.elf.flag(DT_FLAGS_1) & DF_1_NOW)

    def test_it_looks_for_libraries_in_no_place_of_its_own(self):
        self.assertNotIn(DT_RPATH, [tag for tag, _ in self.elf.dynamic])
        self.assertNotIn(DT_RUNPATH, [tag for tag, _ in self.elf.dynamic])

    def test_stacks_and_copies_are_checked(self):
        self.assertTrue("__stack_chk_fail" in self.imported)
        checked = {name for name in self.imported if name.endswith("_chk")}
        self.assertGreaterEqual(len(checked), 2, checked)

    def test_the_library_checks_its_arguments(self):
        self.assertTrue([name for name in self.imported if "glibcxx_assert_fail" in name], "_GLIBCXX_ASSERTIONS")

    @unittest.skipUnless(platform.machine() == "x86_64", "of x86 alone")
    def test_functions_of_ours_may_be_the_goal_of_a_jump_and_nothing_else(self):
        """-fcf-protection: the mark of the whole file is lost where the C library's start code has none."""
        ours = [self.elf.bytes_at(address, 4) for name, is_function, section, address in self.elf.symbols(SHT_SYMTAB)
                if is_function and section and (name == "main" or name.startswith("_ZN8dynasurf")) and ".cold" not in name]
        if not ours:
            self.skipTest("the symbols were stripped")
        self.assertGreater(sum(code == ENDBR64 for code in ours) / len(ours), 0.5)


if __name__ == "__main__":
    unittest.main()
