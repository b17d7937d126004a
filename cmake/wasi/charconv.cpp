#include <charconv>

#if _LIBCPP_VERSION < 200000
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <string>

namespace std {
namespace {

const char* after_digits(const char* at, const char* last) {
  while (at != last && isdigit(static_cast<unsigned char>(*at))) ++at;
  return at;
}

bool begins(const char* at, const char* last, const char* lower) {
  for (; *lower; ++at, ++lower)
    if (at == last || tolower(static_cast<unsigned char>(*at)) != *lower) return false;
  return true;
}

/// The end of the number that begins here; `first` when there is none.
const char* end_of_number(const char* first, const char* last) {
  const char* at = first != last && *first == '-' ? first + 1 : first;
  if (begins(at, last, "infinity")) return at + 8;
  if (begins(at, last, "inf") || begins(at, last, "nan")) return at + 3;
  const char* const whole = after_digits(at, last);
  const char* end = whole;
  if (end != last && *end == '.') end = after_digits(end + 1, last);
  if (end == at || (whole == at && end == at + 1)) return first;
  if (end == last || (*end != 'e' && *end != 'E')) return end;
  const char* exponent = end + 1;
  if (exponent != last && (*exponent == '+' || *exponent == '-')) ++exponent;
  const char* const all = after_digits(exponent, last);
  return all == exponent ? end : all;
}

template <class Number, class Read>
from_chars_result read_number(const char* first, const char* last, Number& value, Read read) {
  const char* const end = end_of_number(first, last);
  if (end == first) return {first, errc::invalid_argument};
  errno = 0;
  const Number number = read(string(first, end).c_str());
  if (errno == ERANGE && (number == 0 || isinf(number))) return {end, errc::result_out_of_range};
  value = number;
  return {end, errc{}};
}

}  // namespace

from_chars_result from_chars(const char* first, const char* last, double& value) {
  return read_number(first, last, value, [](const char* text) { return strtod(text, nullptr); });
}

from_chars_result from_chars(const char* first, const char* last, float& value) {
  return read_number(first, last, value, [](const char* text) { return strtof(text, nullptr); });
}

}  // namespace std
#endif
