#!/usr/bin/env python3
"""Writes src/dynasurf/core/detail/elementary_tables.hpp: the numbers that the elementary functions are made of.

Needs mpmath. Every number is computed with 400 digits and rounded once, so the file is the same wherever it is written.
"""

import pathlib
import textwrap

from mpmath import mp, mpf

mp.dps = 400
OUT = pathlib.Path(__file__).resolve().parent.parent / "src/dynasurf/core/detail/elementary_tables.hpp"


def number(x):
    """A double, as C++ writes it without loss."""
    value = float(x)
    if value == 0:
        return "0"
    mantissa, exponent = value.hex().split("p")
    mantissa = mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa
    return f"{mantissa}p{int(exponent)}"


def pair(x):
    """A double and what it misses."""
    high = mpf(float(x))
    return f"{{{number(high)}, {number(mpf(x) - high)}}}"


def cut(x, bits):
    """x rounded to a multiple of 2^-bits."""
    return mp.nint(x * mpf(2) ** bits) / mpf(2) ** bits


def parts(x, widths):
    """x as doubles of so many bits each; the last one takes all that it can."""
    out, rest = [], mpf(x)
    for width in widths:
        exponent = mp.floor(mp.log(abs(rest), 2))
        out.append(cut(rest, width - 1 - int(exponent)))
        rest -= out[-1]
    return out + [mpf(float(rest))]


def polynomial(f, low, high, count):
    """Coefficients of a nearly best polynomial, the constant first."""
    with mp.workdps(60):
        return mp.chebyfit(f, [low, high], count)[::-1]


def table(kind, name, comment, entries):
    lines = [f"/// {comment}", f"inline constexpr {kind} {name}[{len(entries)}] = {{"]
    row = textwrap.fill(", ".join(entries), 116, break_long_words=False, break_on_hyphens=False)
    return "\n".join(lines + [textwrap.indent(row, "    ") + "};"])


def exponentials():
    step = mp.log(2) / 128
    yield table("Twofold", "powers_of_two", "2^(n/128).", [pair(mpf(2) ** (mpf(n) / 128)) for n in range(128)])
    yield table("double", "log2_over_128", "log(2)/128 in parts; the first two times a whole number below 2^18 are exact.",
                [number(p) for p in parts(step, [35, 35])])
    yield table("double", "log2_parts", "log(2) in parts; the first times a whole number below 2^11 is exact.",
                [number(cut(mp.log(2), 42)), number(mp.log(2) - cut(mp.log(2), 42))])
    yield f"/// 1/log(2) and 1/log(10).\ninline constexpr Twofold one_over_log2 = {pair(1 / mp.log(2))};"
    yield f"inline constexpr Twofold one_over_log10 = {pair(1 / mp.log(10))};"


def logarithms():
    entries = []
    for n in range(128):
        low = mpf(0.703125) + mpf(n) / 256 if n < 76 else 1 + mpf(n - 76) / 128
        high = mpf(0.703125) + mpf(n + 1) / 256 if n < 76 else 1 + mpf(n - 75) / 128
        inverse = mpf(1) if n in (75, 76) else cut(2 / (low + high), 9)
        high_part = cut(-mp.log(inverse), 42)
        entries.append(f"{{{number(inverse)}, {number(high_part)}, {number(-mp.log(inverse) - high_part)}}}")
    yield table("LogCell", "log_cells",
                "For each 128th of an octave from 0.703125 on: a short number near the inverse, and minus its logarithm.",
                entries)


def angles():
    yield table("double", "half_pi_parts", "pi/2 in parts; the first three times a whole number below 2^20 are exact.",
                [number(p) for p in parts(mp.pi / 2, [33, 33, 33])])
    yield f"inline constexpr Twofold half_pi = {pair(mp.pi / 2)};"
    yield table("std::uint32_t", "two_over_pi", "2/pi behind the point, 32 bits each.",
                [hex(int(mp.floor(2 / mp.pi * mpf(2) ** (32 * (n + 1)))) & 0xFFFFFFFF) for n in range(38)])
    sine = lambda t: (mp.sin(mp.sqrt(t)) / mp.sqrt(t) - 1) / t
    cosine = lambda t: (mp.cos(mp.sqrt(t)) - 1 + t / 2) / (t * t)
    yield table("double", "sine_terms", "(sin(r)/r - 1) / r^2 as a polynomial in r^2, for |r| up to pi/4.",
                [number(c) for c in polynomial(sine, mpf(10) ** -20, mpf("0.62"), 7)])
    yield table("double", "cosine_terms", "(cos(r) - 1 + r^2/2) / r^4 as a polynomial in r^2, for |r| up to pi/4.",
                [number(c) for c in polynomial(cosine, mpf(10) ** -15, mpf("0.62"), 7)])
    yield table("Twofold", "arc_tangents", "The arc tangents of n/32.", [pair(mp.atan(mpf(n) / 32)) for n in range(33)])


def error_function():
    scaled = lambda x: mp.exp(x * x) * mp.erfc(x)
    lines = []
    for n in range(52):
        if n < 4:
            low, high = mpf(n) / 8, mpf(n + 1) / 8
        else:
            octave = mpf(2) ** ((n - 4) // 8 - 1)
            low, high = octave * (1 + mpf((n - 4) % 8) / 8), octave * (1 + mpf((n - 4) % 8 + 1) / 8)
        middle, half = (low + high) / 2, (high - low) / 2
        terms = polynomial(lambda s: scaled(middle + s), -half, half, 13)
        rest = [number(c) for c in terms[1:]]
        lines.append(f"{{{number(middle)}, {pair(terms[0])}, {{{', '.join(rest)}}}}}")
    yield table("ErfcCell", "erfc_cells",
                "exp(x^2) erfc(x) as polynomials about the middles of cells: 4 below 1/2, then 8 in each octave to 32.",
                lines)


HEAD = """#pragma once
#include <cstdint>

#include "dynasurf/core/detail/twofold.hpp"

// Written by tools/elementary_tables.py.
// clang-format off

namespace dynasurf::own::detail {

struct LogCell {
  double inverse, high, low;
};

struct ErfcCell {
  double middle;
  Twofold value;
  double terms[12];
};
"""


def main():
    parts_of_file = [HEAD]
    for group in (exponentials, logarithms, angles, error_function):
        parts_of_file += list(group())
    OUT.write_text("\n\n".join(part.rstrip() for part in parts_of_file) + "\n\n}  // namespace dynasurf::own::detail\n// clang-format on\n")


if __name__ == "__main__":
    main()
