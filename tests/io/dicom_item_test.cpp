#include "dynasurf/io/detail/dicom_item.hpp"

#include <new>
#include <vector>

#include <gtest/gtest.h>

namespace dynasurf::io::dicom {
namespace {

/// A file that says no more than what it is.
void fill(DcmFileFormat& file) {
  Item item(*file.getDataset());
  item.text(DCM_SOPClassUID, UID_SecondaryCaptureImageStorage);
  item.text(DCM_SOPInstanceUID, "2.25.1");
}

TEST(DicomItem, BytesHoldAHeadAndTheDataSet) {
  DcmFileFormat file;
  fill(file);
  const std::string bytes = bytes_of(file, "study.dcm");
  EXPECT_EQ(bytes.substr(128, 4), "DICM");
  EXPECT_NE(bytes.find(UID_SecondaryCaptureImageStorage), std::string::npos);
}

TEST(DicomItem, AHeadWithoutAValueIsTakenForWantOfMemory) {
  DcmFileFormat file;
  fill(file);
  bytes_of(file, "study.dcm");
  DcmMetaInfo& head = *file.getMetaInfo();
  std::vector<DcmTagKey> tags;
  for (unsigned long n = 0; n < head.card(); ++n) tags.emplace_back(head.getElement(n)->getTag().getXTag());
  ASSERT_GE(tags.size(), 7U);
  for (const DcmTagKey& tag : tags) {
    EXPECT_NO_THROW(require_values(head)) << tag;
    DcmElement* element = nullptr;
    must(head.findAndGetElement(tag, element, OFFalse, OFTrue), "copy a value");
    must(head.insertEmptyElement(tag), "leave a value out");
    EXPECT_THROW(require_values(head), std::bad_alloc) << tag;
    must(head.insert(element, OFTrue), "bring a value back");
  }
}

/// The bytes of a whole number in decimal digits, the lowest first.
std::vector<int> low_bytes_of(std::string digits) {
  std::vector<int> bytes;
  while (!digits.empty()) {
    std::string quotient;
    int rest = 0;
    for (const char digit : digits) {
      rest = 10 * rest + (digit - '0');
      if (!quotient.empty() || rest >= 256) quotient += static_cast<char>('0' + rest / 256);
      rest %= 256;
    }
    bytes.push_back(rest);
    digits = quotient;
  }
  return bytes;
}

TEST(DicomItem, UidsHoldUuidsOfTheVersionFromNames) {
  Sha256 content{};
  for (const int last : {0, 1, 2, 3, 4, 5, 6, 7}) {
    content.back() = static_cast<std::uint8_t>(last);
    const std::string uid = uid_of(content, "study");
    ASSERT_TRUE(uid.starts_with("2.25."));
    const std::vector<int> bytes = low_bytes_of(uid.substr(5));
    ASSERT_LE(bytes.size(), 16U);
    ASSERT_GE(bytes.size(), 10U);
    EXPECT_EQ(bytes[9] >> 4, 5);  // byte 6 from the top: the version
    EXPECT_EQ(bytes[7] >> 6, 2);  // byte 8: the variant
    EXPECT_NE(uid, uid_of(content, "series"));
  }
}

TEST(DicomItem, DecimalsHaveAtMostSixteenCharactersAndLoseTheLastDigitsOnly) {
  EXPECT_EQ(decimals({1, -0.5, 0, 1e-13}), "1\\-0.5\\0\\0");
  for (const double value : {0.1 + 0.2, -1.0 / 3, -1.0 / 3e5, 123456789.123456789, -6.02214076e23}) {
    EXPECT_LE(decimal(value).size(), 16U);
    EXPECT_NEAR(std::stod(decimal(value)) / value, 1, 1e-9) << decimal(value);
  }
}

}  // namespace
}  // namespace dynasurf::io::dicom
