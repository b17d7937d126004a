#include "dynasurf/io/detail/dicom_item.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <new>

#include <dcmtk/dcmdata/dcostrmb.h>

namespace dynasurf::io::dicom {
namespace {

/// Decimal digits of a 128-bit number.
std::string digits_of(std::array<unsigned char, 16> number) {
  std::string digits;
  while (std::any_of(number.begin(), number.end(), [](unsigned char b) { return b != 0; })) {
    unsigned rest = 0;
    for (unsigned char& byte : number) {
      rest = rest * 256 + byte;
      byte = static_cast<unsigned char>(rest / 10);
      rest %= 10;
    }
    digits.insert(digits.begin(), static_cast<char>('0' + rest));
  }
  return digits.empty() ? "0" : digits;
}

bool has_value(DcmElement& element) {
  char* text = nullptr;
  Uint8* bytes = nullptr;
  Uint32 number = 0;
  // The head of a file (group 2) holds the length of the group, its version, and texts.
  switch (element.ident()) {
    case EVR_UL:
      return element.getUint32(number).good() && number > 0;
    case EVR_OB:
      return element.getUint8Array(bytes).good() && bytes != nullptr;
    default:
      return element.getString(text).good() && text != nullptr && *text != '\0';
  }
}

}  // namespace

void require_values(DcmMetaInfo& head) {
  for (unsigned long n = 0; n < head.card(); ++n)
    if (!has_value(*head.getElement(n))) throw std::bad_alloc();
}

std::string decimal(double value) {
  if (std::abs(value) < 1e-12) return "0";
  std::array<char, 40> buffer;
  for (int digits = 15; digits > 3; --digits) {
    std::snprintf(buffer.data(), buffer.size(), "%.*g", digits, value);
    // A decimal string (DS) has 16 bytes at most; sign, point and exponent take some of them.
    if (std::string(buffer.data()).size() <= 16) break;
  }
  return buffer.data();
}

std::string decimals(std::initializer_list<double> values) {
  std::string text;
  for (const double v : values) text += (text.empty() ? "" : "\\") + decimal(v);
  return text;
}

std::string uid_of(const Sha256& content, std::string_view role) {
  Hasher hasher;
  hasher.add(content.data(), content.size());
  hasher.add(role.data(), role.size());
  const Sha256 digest = hasher.finish();
  std::array<unsigned char, 16> uuid;
  std::copy_n(digest.begin(), 16, uuid.begin());
  uuid[6] = static_cast<unsigned char>((uuid[6] & 0x0f) | 0x50);  // version 5: named by a hash
  uuid[8] = static_cast<unsigned char>((uuid[8] & 0x3f) | 0x80);  // the variant of RFC 4122
  return "2.25." + digits_of(uuid);
}

std::string bytes_of(DcmFileFormat& file, const std::string& where) {
  // saveFile() of DCMTK does not look whether what it writes arrives (a full disk), so only memory is left to it.
  std::array<char, 65536> buffer;
  DcmOutputBufferStream stream(buffer.data(), buffer.size());
  std::string bytes;
  OFCondition status = EC_StreamNotifyClient;
  file.transferInit();
  // DCMTK asks for room in this way whenever the buffer is full.
  while (status == EC_StreamNotifyClient) {
    status = file.write(stream, EXS_LittleEndianExplicit, EET_ExplicitLength, nullptr, EGL_withoutGL);
    void* piece = nullptr;
    offile_off_t length = 0;
    stream.flushBuffer(piece, length);
    bytes.append(static_cast<const char*>(piece), length);
  }
  file.transferEnd();
  if (status.bad()) throw IoError(where + ": cannot write: " + status.text());
  require_values(*file.getMetaInfo());
  return bytes;
}

}  // namespace dynasurf::io::dicom
