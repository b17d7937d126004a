#pragma once
#include <span>
#include <string>
#include <string_view>

namespace dynasurf::io::detail {

/// Text that may stand inside an attribute or element of XML.
std::string xml_text(std::string_view text);

/// Field data that name the space of a mesh, as 3D Slicer reads them: SPACE = LPS, written as character codes.
inline constexpr std::string_view lps_field =
    "<FieldData>\n<Array type=\"String\" Name=\"SPACE\" NumberOfTuples=\"1\" format=\"ascii\">76 80 83 0</Array>\n"
    "</FieldData>\n";

/// A VTK XML file whose numbers follow the markup as raw little-endian bytes. The markup is built by the caller with
/// the elements that `array` gives back; `file` puts both together.
class VtkXml {
 public:
  /// Stores values in the appended part and gives the DataArray element that points to them. T: float, double,
  /// std::uint8_t, std::int64_t.
  template <class T>
  std::string array(std::string_view name, int components, std::span<const T> values);

  /// The whole file. `type` is PolyData or ImageData, `body` the element of that type.
  std::string file(std::string_view type, std::string_view body) const;

 private:
  std::string appended_;
};

}  // namespace dynasurf::io::detail
