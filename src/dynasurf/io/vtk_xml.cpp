#include "dynasurf/io/detail/vtk_xml.hpp"

#include <cstdint>
#include <type_traits>

#include "dynasurf/io/detail/bytes.hpp"

namespace dynasurf::io::detail {

std::string xml_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

template <class T>
std::string VtkXml::array(std::string_view name, int components, std::span<const T> values) {
  constexpr std::string_view type = std::is_same_v<T, float>          ? "Float32"
                                    : std::is_same_v<T, double>       ? "Float64"
                                    : std::is_same_v<T, std::uint8_t> ? "UInt8"
                                                                      : "Int64";
  const std::size_t offset = appended_.size();
  // The file says UInt64, also where sizes have 32 bits.
  append(appended_, static_cast<std::uint64_t>(values.size_bytes()));
  appended_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  return "<DataArray type=\"" + std::string(type) + "\" Name=\"" + xml_text(name) + "\" NumberOfComponents=\"" +
         std::to_string(components) + "\" format=\"appended\" offset=\"" + std::to_string(offset) + "\"/>\n";
}

template std::string VtkXml::array(std::string_view, int, std::span<const float>);
template std::string VtkXml::array(std::string_view, int, std::span<const double>);
template std::string VtkXml::array(std::string_view, int, std::span<const std::uint8_t>);
template std::string VtkXml::array(std::string_view, int, std::span<const std::int64_t>);

std::string VtkXml::file(std::string_view type, std::string_view body) const {
  std::string out = "<?xml version=\"1.0\"?>\n<VTKFile type=\"" + std::string(type) +
                    "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n";
  out += body;
  out += "<AppendedData encoding=\"raw\">\n_";
  out += appended_;
  out += "\n</AppendedData>\n</VTKFile>\n";
  return out;
}

}  // namespace dynasurf::io::detail
