#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/gzip.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/mesh/measures.hpp"

namespace dynasurf::io::detail {
namespace {

/// A ZIP archive of deflated entries, all of the first day that the format knows, so that the same content gives the
/// same bytes.
class ZipArchive {
 public:
  /// Throws IoError where the content, packed or not, is above the 4 GiB of the format.
  void add(std::string_view name, std::string_view content) {
    // What gzip writes is 10 bytes of header, the same deflated stream, its CRC-32 and size.
    constexpr std::size_t header = 10, trailer = 8, crc = 4;
    constexpr std::uint64_t most = 0xffffffff;
    const std::string packed = gzip(content);
    const std::size_t size = packed.size() - header - trailer;
    if (content.size() > most || bytes_.size() + packed.size() > most)
      throw IoError(std::string(name) + ": the archive would be larger than 4 GiB");
    std::string facts;
    append<std::uint16_t>(facts, 20);      // version 2.0
    append<std::uint16_t>(facts, 0);       // flags
    append<std::uint16_t>(facts, 8);       // deflated
    append<std::uint16_t>(facts, 0);       // time
    append<std::uint16_t>(facts, 0x0021);  // 1 January 1980
    facts += packed.substr(header + size, crc);
    append<std::uint32_t>(facts, size);
    append<std::uint32_t>(facts, content.size());
    append<std::uint16_t>(facts, name.size());
    append<std::uint16_t>(facts, 0);  // extra fields

    append<std::uint32_t>(directory_, 0x02014b50);
    append<std::uint16_t>(directory_, 20);  // made by version 2.0
    directory_ += facts;
    directory_.append(10, '\0');  // comment, disk, attributes
    append<std::uint32_t>(directory_, bytes_.size());
    directory_ += name;
    ++entries_;

    append<std::uint32_t>(bytes_, 0x04034b50);
    bytes_ += facts;
    bytes_ += name;
    bytes_.append(packed, header, size);
  }

  std::string finished() && {
    const std::size_t begin = bytes_.size();
    bytes_ += directory_;
    append<std::uint32_t>(bytes_, 0x06054b50);
    append<std::uint32_t>(bytes_, 0);  // disks
    append<std::uint16_t>(bytes_, entries_);
    append<std::uint16_t>(bytes_, entries_);
    append<std::uint32_t>(bytes_, directory_.size());
    append<std::uint32_t>(bytes_, begin);
    append<std::uint16_t>(bytes_, 0);  // comment
    return std::move(bytes_);
  }

 private:
  std::string bytes_, directory_;
  std::uint16_t entries_ = 0;
};

constexpr std::string_view content_types =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
)";

constexpr std::string_view relationships =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
)";

/// A closed mesh is a "model", which has an inside to print; an open one a "surface".
std::string model_of(const TriMesh& mesh) {
  const bool is_closed = mesh::topology(mesh).closed();
  std::string out =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en-US\" "
      "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
      "<metadata name=\"Application\">dynasurf</metadata>\n<resources>\n<object id=\"1\" type=\"" +
      std::string(is_closed ? "model" : "surface") + "\">\n<mesh>\n<vertices>\n";
  constexpr std::string_view axes[] = {"x", "y", "z"};
  for (const Vec3& v : mesh.vertices) {
    out += "<vertex";
    for (int a = 0; a < 3; ++a) {
      out += " ";
      out += axes[a];
      out += "=\"";
      append_text(out, v[a]);
      out += '"';
    }
    out += "/>\n";
  }
  out += "</vertices>\n<triangles>\n";
  for (const auto& [a, b, c] : mesh.triangles)
    out += "<triangle v1=\"" + std::to_string(a) + "\" v2=\"" + std::to_string(b) + "\" v3=\"" + std::to_string(c) +
           "\"/>\n";
  return out + "</triangles>\n</mesh>\n</object>\n</resources>\n<build>\n<item objectid=\"1\"/>\n</build>\n</model>\n";
}

}  // namespace

std::string encode_3mf(const TriMesh& mesh) {
  ZipArchive archive;
  archive.add("[Content_Types].xml", content_types);
  archive.add("_rels/.rels", relationships);
  archive.add("3D/3dmodel.model", model_of(mesh));
  return std::move(archive).finished();
}

}  // namespace dynasurf::io::detail
