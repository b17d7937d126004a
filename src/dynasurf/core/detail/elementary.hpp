#pragma once

/// Elementary functions that return the same bytes on every machine.
///
/// The functions of `cmath` are rounded as each library, and each processor, finds best. These are made of + - * / and
/// square roots of doubles alone, which IEEE 754 defines to the last bit, so every compiler and machine agrees (with
/// contraction off, and to nearest). They err by less than 1 unit in the last place; what is exact comes out exact,
/// and zeros, infinities and NaN follow C. What `cmath` computes exactly on every machine (sqrt, floor, fmod,
/// remainder, fma, ldexp, ...) is taken from there.
namespace dynasurf::own {

double exp(double x);
double expm1(double x);
double log(double x);
double log2(double x);
double log10(double x);
double pow(double x, double y);
double erfc(double x);

double sin(double x);
double cos(double x);
double tan(double x);
double asin(double x);
double acos(double x);
double atan2(double y, double x);

double cbrt(double x);
double hypot(double x, double y);
double hypot(double x, double y, double z);

}  // namespace dynasurf::own
