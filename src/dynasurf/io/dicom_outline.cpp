#include "dynasurf/io/detail/dicom_outline.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <string_view>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/detail/dicom_dictionary.hpp"

namespace dynasurf::io {
namespace {

constexpr std::uint32_t undefined_length = 0xffffffff;
constexpr std::uint32_t item_tag = 0xfffee000, item_end = 0xfffee00d, sequence_end = 0xfffee0dd;
constexpr std::uint32_t syntax_tag = 0x00020010, pixel_tag = 0x7fe00010;
constexpr std::size_t most_fragments = 1'000'001;  // a frame each, and the table of their offsets

std::string text_of(std::uint32_t tag) {
  std::array<char, 16> text;
  std::snprintf(text.data(), text.size(), "(%04x,%04x)", tag >> 16, tag & 0xffff);
  return text.data();
}

/// A value representation: two letters.
using Vr = std::array<char, 2>;

bool is_one_of(Vr vr, std::string_view letters) {
  for (std::size_t n = 0; n < letters.size(); n += 3)
    if (letters[n] == vr[0] && letters[n + 1] == vr[1]) return true;
  return false;
}
bool has_short_length(Vr vr) { return is_one_of(vr, "AE AS AT CS DA DS DT FD FL IS LO LT PN SH SL SS ST TM UI UL US"); }
bool has_long_length(Vr vr) { return is_one_of(vr, "OB OD OF OL OV OW SQ SV UC UN UR UT UV"); }

/// The uncompressed syntaxes and run lengths; each is told from its UID.
void take_syntax(const std::string& uid, const std::string& where, DicomOutline& outline) {
  constexpr std::string_view implicit = "1.2.840.10008.1.2", little = "1.2.840.10008.1.2.1",
                             big = "1.2.840.10008.1.2.2", run_lengths = "1.2.840.10008.1.2.5";
  if (uid == implicit || uid == little || uid == big || uid == run_lengths) {
    outline.explicit_vr = uid != implicit;
    outline.big_endian = uid == big;
    outline.run_lengths = uid == run_lengths;
    return;
  }
  struct Packed {
    std::string_view begin, name, hint;
  };
  constexpr std::string_view with_gdcm = "convert it with: gdcmconv --raw IN OUT", elsewhere = "unpack it first";
  constexpr Packed known[] = {
      {"1.2.840.10008.1.2.1.99", "deflated", "convert it with: dcmconv +te IN OUT"},
      {"1.2.840.10008.1.2.4.8", "JPEG-LS", "convert it with: dcmdjpls IN OUT"},
      {"1.2.840.10008.1.2.4.9", "JPEG 2000", with_gdcm},
      {"1.2.840.10008.1.2.4.10", "MPEG video", elsewhere},
      {"1.2.840.10008.1.2.4.11", "JPEG XL", elsewhere},
      {"1.2.840.10008.1.2.4.20", "High-Throughput JPEG 2000", elsewhere},
      {"1.2.840.10008.1.2.4.5", "JPEG", "convert it with: dcmdjpeg IN OUT"},
      {"1.2.840.10008.1.2.4.6", "JPEG", "convert it with: dcmdjpeg IN OUT"},
      {"1.2.840.10008.1.2.4.7", "JPEG", "convert it with: dcmdjpeg IN OUT"},
  };
  for (const Packed& packed : known)
    if (uid.starts_with(packed.begin))
      throw InputError(where + ": its pixels are packed as " + std::string(packed.name) + " (" + uid +
                       "), which is not read; " + std::string(packed.hint));
  throw InputError(where + ": its transfer syntax is " + (uid.empty() ? "not told" : "\"" + uid + "\"") +
                   ", which is not read; expected one without packing, or run lengths");
}

class Walk {
 public:
  Walk(const std::filesystem::path& path, std::span<const std::uint32_t> wanted)
      : file_(path), where_(path.string()), wanted_(wanted.begin(), wanted.end()) {
    std::sort(wanted_.begin(), wanted_.end());
    found_.resize(wanted_.size());
  }

  DicomOutline outline() {
    const bool has_preamble = file_.size() >= 132 && std::string_view(chars(128, 4), 4) == "DICM";
    if (has_preamble) place_ = 132;
    read_meta();
    levels_[0] = {Kind::items, file_.size(), !outline_.explicit_vr, false, false, 0};
    depth_ = 1;
    while (step()) {
    }
    return std::move(outline_);
  }

 private:
  enum class Kind { items, sequence, fragments };  // items: elements of the data set or of an item
  struct Level {
    Kind kind = Kind::items;
    std::uint64_t end = 0;  // of the file, for a length that is not told
    bool implicit = false;  // in an element of unknown representation all is implicit
    bool until_mark = false;
    bool kept = false;  // fragments of the pixel data
    std::uint32_t last_tag = 0;
  };
  struct Element {
    std::uint32_t tag = 0, length = 0;
    Vr vr{};
    std::uint64_t begin = 0, value = 0;
  };

  [[noreturn]] void fail(const std::string& reason) const { throw InputError(where_ + ": " + reason); }
  [[noreturn]] void fail_cut(std::uint32_t tag) const {
    fail("is damaged or cut off: element " + text_of(tag) + " at byte " + std::to_string(place_) +
         " reaches beyond the end of what holds it");
  }

  const char* chars(std::uint64_t place, std::size_t count) {
    return reinterpret_cast<const char*>(file_.at(place, count));
  }
  std::uint32_t number(std::uint64_t place, std::size_t bytes) {
    const unsigned char* at = file_.at(place, bytes);
    std::uint32_t value = 0;
    for (std::size_t n = 0; n < bytes; ++n)
      value |= std::uint32_t{at[outline_.big_endian ? bytes - 1 - n : n]} << 8 * n;
    return value;
  }
  /// That `bytes` follow before `end`.
  void need(std::uint64_t bytes, std::uint64_t end, std::uint32_t tag) const {
    if (end - place_ < bytes) fail_cut(tag);
  }

  /// Tag, representation and length of what stands at `place_`, which goes on to the value.
  Element read_element(bool implicit, std::uint64_t end) {
    Element e;
    e.begin = place_;
    if (end - place_ < 8)
      fail("is damaged or cut off: " + std::to_string(end - place_) + " bytes at byte " + std::to_string(place_) +
           " are no element");
    e.tag = number(place_, 2) << 16 | number(place_ + 2, 2);
    const bool is_mark = e.tag >> 16 == 0xfffe;
    if (!implicit && !is_mark) {
      const char* letters = chars(place_ + 4, 2);
      e.vr = {letters[0], letters[1]};
    }
    if (implicit || is_mark) {
      e.length = number(place_ + 4, 4);
      place_ += 8;
    } else if (has_long_length(e.vr)) {
      need(12, end, e.tag);
      e.length = number(place_ + 8, 4);
      place_ += 12;
    } else if (has_short_length(e.vr)) {
      e.length = number(place_ + 6, 2);
      place_ += 8;
    } else {
      fail("is damaged: element " + text_of(e.tag) + " at byte " + std::to_string(place_) +
           " has no representation that DICOM knows");
    }
    e.value = place_;
    if (++elements_ > most_dicom_elements)
      fail("holds more than " + std::to_string(most_dicom_elements) + " elements; expected an image");
    return e;
  }

  /// Group 2, which is always explicit little endian and names the syntax of all that follows.
  void read_meta() {
    std::string uid;
    bool has_meta = false;
    while (file_.size() - place_ >= 8 && number(place_, 2) == 2) {
      const Element e = read_element(false, file_.size());
      if (e.length == undefined_length) fail("is damaged: its meta header holds a sequence");
      need(e.length, file_.size(), e.tag);
      if (e.tag == syntax_tag) {
        if (e.length > 64) fail("is damaged: its transfer syntax is longer than 64 bytes");
        for (const char c : std::string(chars(e.value, e.length), e.length))
          if (c != '\0' && c != ' ') uid += (c >= '0' && c <= '9') || c == '.' ? c : '?';
      }
      has_meta = true;
      place_ += e.length;
    }
    if (has_meta)
      take_syntax(uid, where_, outline_);
    else
      guess_syntax();
  }

  /// Without a meta header the first element tells: its group is small, and letters behind its tag are explicit.
  void guess_syntax() {
    if (file_.size() - place_ < 8) fail("is damaged or cut off: holds no element");
    const unsigned char* head = file_.at(place_, 8);
    const Vr vr{static_cast<char>(head[4]), static_cast<char>(head[5])};
    outline_.big_endian = head[0] == 0 && head[1] != 0;
    outline_.explicit_vr = has_long_length(vr) || has_short_length(vr);
    if (outline_.big_endian && !outline_.explicit_vr) fail("is neither explicit nor little-endian DICOM");
  }

  void open(Kind kind, std::uint64_t end, bool implicit, bool until_mark, bool kept = false) {
    if (depth_ == levels_.size())
      fail("nests sequences more than " + std::to_string(deepest_dicom_nesting) + " deep at byte " +
           std::to_string(place_));
    levels_[depth_++] = {kind, end, implicit, until_mark, kept, 0};
  }
  void close() {
    // Back at the first level: a wanted element ends here.
    if (--depth_ == 1 && in_wanted_) {
      outline_.wanted.back().end = place_;
      in_wanted_ = false;
    }
  }

  /// The next element or mark; false at the end of the file.
  bool step() {
    Level& level = levels_[depth_ - 1];
    if (place_ == level.end && (!level.until_mark || depth_ == 1)) {
      if (depth_ == 1) return false;
      close();
      return true;
    }
    const Element e = read_element(level.implicit, level.end);
    if (in_wanted_ && ++nested_ > most_nested_elements)
      fail("holds more than " + std::to_string(most_nested_elements) + " sequence items and elements where its " +
           "description stands");
    if (level.kind == Kind::items)
      step_in_items(level, e);
    else
      step_in_sequence(level, e);
    return true;
  }

  void step_in_items(Level& level, const Element& e) {
    if (e.tag == item_end && level.until_mark && depth_ > 1) return close();
    if (e.tag >> 16 == 0xfffe || e.tag >> 16 < 3)
      fail("is damaged: " + text_of(e.tag) + " at byte " + std::to_string(e.begin) + " has no place there");
    if (in_wanted_ && e.tag <= level.last_tag && ++unordered_ > most_unordered_elements)
      fail("holds more than " + std::to_string(most_unordered_elements) + " elements that are out of order");
    level.last_tag = e.tag;
    if (depth_ == 1) look_for(e);
    enter_or_pass(level, e);
  }

  void step_in_sequence(const Level& level, const Element& e) {
    if (e.tag == sequence_end && level.until_mark) return close();
    if (e.tag != item_tag)
      fail("is damaged: " + text_of(e.tag) + " at byte " + std::to_string(e.begin) + " stands where an item is due");
    if (level.kind == Kind::sequence && e.length == undefined_length)
      return open(Kind::items, level.end, level.implicit, true);
    need(e.length, level.end, e.tag);
    if (level.kind == Kind::sequence) return open(Kind::items, place_ + e.length, level.implicit, false);
    if (level.kept && outline_.fragments.size() == most_fragments) fail("holds more than a million packed frames");
    if (level.kept) outline_.fragments.push_back({place_, place_ + e.length});
    place_ += e.length;
  }

  /// An element of the first level: whether it is one of those that are asked for.
  void look_for(const Element& e) {
    if (e.tag == pixel_tag) {
      if (outline_.pixels) fail("holds its pixel data twice");
      outline_.pixels = FilePiece{e.value, e.value + e.length};
      outline_.pixels_are_words = outline_.explicit_vr ? e.vr == Vr{'O', 'W'} : true;
      return;
    }
    outline_.has_real_pixels = outline_.has_real_pixels || e.tag == 0x7fe00008 || e.tag == 0x7fe00009;
    const auto it = std::lower_bound(wanted_.begin(), wanted_.end(), e.tag);
    if (it == wanted_.end() || *it != e.tag) return;
    const std::size_t n = it - wanted_.begin();
    if (found_[n]) fail("holds element " + text_of(e.tag) + " twice");
    if (outline_.pixels) fail("holds element " + text_of(e.tag) + " behind its pixel data");
    found_[n] = true;
    outline_.wanted.push_back({e.begin, e.value});
    in_wanted_ = true;
  }

  void enter_or_pass(const Level& level, const Element& e) {
    const bool is_pixels = depth_ == 1 && e.tag == pixel_tag;
    const bool known_sequence = e.vr == Vr{'S', 'Q'} || (level.implicit && in_wanted_ && dicom::is_sequence(e.tag));
    const bool unknown = e.vr == Vr{'U', 'N'};
    if (e.length == undefined_length) {
      if (is_pixels && !outline_.run_lengths) fail("is damaged: its pixel data have no length, yet are not packed");
      if (unknown && outline_.big_endian)
        fail("holds a sequence of unknown kind in big-endian order, which is not read");
      // Pictures of folders are packed like the pixels.
      if (is_one_of(e.vr, "OB OW") || e.tag == pixel_tag)
        return open(Kind::fragments, level.end, level.implicit, true, is_pixels);
      return open(Kind::sequence, level.end, level.implicit || unknown, true);
    }
    need(e.length, level.end, e.tag);
    // What nobody wants is passed over, sequences too.
    if (in_wanted_ && known_sequence) return open(Kind::sequence, place_ + e.length, level.implicit, false);
    if (in_wanted_ && e.length > longest_dicom_value)
      fail("element " + text_of(e.tag) + " is " + std::to_string(e.length) + " bytes long; expected at most " +
           std::to_string(longest_dicom_value));
    place_ += e.length;
    if (depth_ == 1 && in_wanted_) {
      outline_.wanted.back().end = place_;
      in_wanted_ = false;
    }
  }

  FileWindow file_;
  std::string where_;
  std::vector<std::uint32_t> wanted_;
  std::vector<bool> found_;
  DicomOutline outline_;
  std::uint64_t place_ = 0, elements_ = 0, nested_ = 0, unordered_ = 0;
  bool in_wanted_ = false;
  std::array<Level, deepest_dicom_nesting + 1> levels_;
  std::size_t depth_ = 0;
};

}  // namespace

DicomOutline outline_of_dicom(const std::filesystem::path& path, std::span<const std::uint32_t> wanted) {
  DicomOutline outline = Walk(path, wanted).outline();
  if (!outline.fragments.empty()) outline.fragments.erase(outline.fragments.begin());
  return outline;
}

}  // namespace dynasurf::io
