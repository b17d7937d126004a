#pragma once
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <dcmtk/config/osconfig.h>
// DCMTK asks for its configuration header first.
#include <dcmtk/dcmdata/dctk.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/dicom_load.hpp"
#include "dynasurf/io/detail/digest.hpp"

// How DICOM objects are filled. For the sources of this module: it brings DCMTK with it.
namespace dynasurf::io::dicom {

inline void must(const OFCondition& status, const std::string& doing) {
  if (status.bad()) throw IoError("cannot " + doing + ": " + status.text());
}

/// A sequence item (or the data set) being filled.
class Item {
 public:
  explicit Item(DcmItem& item) : item_(&item) { require_dictionary(); }

  void text(const DcmTagKey& tag, const std::string& value) {
    must(item_->putAndInsertString(tag, value.c_str()), name(tag));
  }
  void number(const DcmTagKey& tag, int value) {
    must(item_->putAndInsertUint16(tag, static_cast<Uint16>(value)), name(tag));
  }
  void numbers(const DcmTagKey& tag, const std::vector<Uint16>& values) {
    must(item_->putAndInsertUint16Array(tag, values.data(), values.size()), name(tag));
  }
  void counts(const DcmTagKey& tag, const std::vector<Uint32>& values) {
    auto element = std::make_unique<DcmUnsignedLong>(tag);
    must(element->putUint32Array(values.data(), values.size()), name(tag));
    must(item_->insert(element.get(), OFTrue), name(tag));
    (void)element.release();
  }
  void tags(const DcmTagKey& tag, const std::vector<DcmTagKey>& values) {
    std::vector<Uint16> words;
    for (const DcmTagKey& t : values) {
      words.push_back(t.getGroup());
      words.push_back(t.getElement());
    }
    auto element = std::make_unique<DcmAttributeTag>(tag);
    must(element->putUint16Array(words.data(), values.size()), name(tag));
    must(item_->insert(element.get(), OFTrue), name(tag));
    (void)element.release();
  }
  void pixels(const std::vector<Uint16>& values) {
    must(item_->putAndInsertUint16Array(DCM_PixelData, values.data(), values.size()), "store the pixels");
  }
  void empty_sequence(const DcmTagKey& tag) { must(item_->insertEmptyElement(tag), name(tag)); }
  Item add(const DcmTagKey& tag) {
    DcmItem* item = nullptr;
    must(item_->findOrCreateSequenceItem(tag, item, -2), name(tag));
    return Item(*item);
  }
  /// Codes of more than 16 characters have an attribute of their own.
  void code(const DcmTagKey& tag, const std::string& value, const std::string& meaning,
            const std::string& scheme = "SCT") {
    Item item = add(tag);
    item.text(value.size() > 16 ? DCM_LongCodeValue : DCM_CodeValue, value);
    item.text(DCM_CodingSchemeDesignator, scheme);
    item.text(DCM_CodeMeaning, meaning);
  }

 private:
  static std::string name(const DcmTagKey& tag) { return std::string("store ") + DcmTag(tag).getTagName(); }
  DcmItem* item_;
};

/// A decimal string: at most 16 characters, so the last digits of long numbers are rounded.
std::string decimal(double value);
std::string decimals(std::initializer_list<double> values);

/// A UID under 2.25, which holds a UUID: hashes of the content and of the object's role in the form of a name-based
/// one, so that the same content gives the same UIDs.
std::string uid_of(const Sha256& content, std::string_view role);

/// DCMTK fills the head of a file while it writes, and does not look whether the values found memory. Throws
/// std::bad_alloc where one has none.
void require_values(DcmMetaInfo& head);

/// A DICOM file as it stands on disk: little endian, explicit lengths. `where` is what errors call it.
std::string bytes_of(DcmFileFormat& file, const std::string& where);

}  // namespace dynasurf::io::dicom
