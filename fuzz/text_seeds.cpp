// Seeds of formats that are text, or that are made by hand.

#include <array>
#include <cstring>

#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/manifest.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/report/detail/normal_groups.hpp"
#include "dynasurf/report/normals.hpp"
#include "dynasurf/synthetic/options.hpp"

#include "seeds.hpp"
#include "support/e57_writer.hpp"
#include "support/laz_writer.hpp"
#include "support/scratch_folder.hpp"
#include "support/toy_options.hpp"

namespace dynasurf::fuzz {
namespace {

namespace fs = std::filesystem;
using io::detail::append;
using test::read_bytes;

TriMesh tetrahedron() {
  return {{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

/// LAS with two points of a format; 1.4 for those that only it has.
std::string las(int format) {
  constexpr std::array<std::uint16_t, 11> records{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
  const bool extended = format >= 6;
  const std::uint16_t record = records[static_cast<std::size_t>(format)];
  const std::size_t header = extended ? 375 : 227;
  std::string out(header + 2 * record, '\0');
  const auto set = [&](std::size_t place, auto value) { std::memcpy(out.data() + place, &value, sizeof value); };
  std::memcpy(out.data(), "LASF", 4);
  set(24, std::uint8_t{1});
  set(25, static_cast<std::uint8_t>(extended ? 4 : 2));
  set(94, static_cast<std::uint16_t>(header));
  set(96, static_cast<std::uint32_t>(header));
  set(104, static_cast<std::uint8_t>(format));
  set(105, record);
  set(107, std::uint32_t{extended ? 0U : 2U});
  for (std::size_t axis = 0; axis < 3; ++axis) set(131 + 8 * axis, 0.001);
  if (extended) set(247, std::uint64_t{2});
  for (std::size_t n = 0; n < 6; ++n) set(header + (n / 3) * record + 4 * (n % 3), static_cast<std::int32_t>(100 * n));
  return out;
}

/// LAZ with points of a format, some in a second chunk.
std::string small_laz(int format) {
  std::vector<test::LazPoint> points(40);
  for (std::size_t n = 0; n < points.size(); ++n) {
    test::LazPoint& p = points[n];
    const auto k = static_cast<std::uint8_t>(n);
    p.place = {static_cast<std::int32_t>(n * n), static_cast<std::int32_t>(70 * n), k % 9 == 0 ? -100000 : 5 * k};
    p.colour = {static_cast<std::uint16_t>(500 * n), 9, static_cast<std::uint16_t>(n)};
    p.returns = static_cast<std::uint8_t>(1 + k % 3);
    p.number = static_cast<std::uint8_t>(1 + k % p.returns);
    p.kind = k % 5;
    p.channel = k / 8 % 4;
    p.source = k / 20;
    p.has_new_time = k % 2 == 0;
  }
  return test::laz(points, {.format = format, .chunk = 30, .extra_bytes = format % 2u});
}

std::string big_endian_ply() {
  std::string out =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n";
  for (int n = 0; n < 3; ++n) out += std::string("\x3f\x80\0\0\0\0\0\0\x40\0\0\0\1\2\3", 15);
  return out + std::string("\3\0\0\0\0\0\0\0\1\0\0\0\2", 13);
}

/// Scans of two points that have every kind of column between them.
std::vector<test::E57Scan> e57_scans() {
  using test::e57_doubles, test::e57_integers, test::e57_singles;
  const std::string pose =
      "<pose type=\"Structure\"><rotation type=\"Structure\"><w type=\"Float\">0.6</w><x type=\"Float\">0.8</x>"
      "</rotation><translation type=\"Structure\"><z type=\"Float\">2</z></translation></pose>";
  const std::string limits =
      "<colorLimits type=\"Structure\"><colorRedMinimum type=\"Integer\"/><colorRedMaximum "
      "type=\"Integer\">255</colorRedMaximum></colorLimits>";
  return {{{e57_singles("cartesianX", {1, 2}), e57_doubles("cartesianY", {1, 2}),
            e57_integers("cartesianZ", -9, 500, {-9, 8}, "scale=\"0.1\" offset=\"3\""),
            e57_integers("cartesianInvalidState", 0, 2, {0, 1}), e57_integers("colorRed", 0, 255, {0, 255}),
            e57_integers("colorGreen", 0, 255, {9, 9}), e57_integers("colorBlue", 5, 5, {5, 5}),
            e57_integers("isColorInvalid", 0, 1, {0, 1})},
           pose + limits,
           3,
           true},
          {{e57_doubles("sphericalRange", {1, 2}), e57_singles("sphericalAzimuth", {1, 2}),
            e57_integers("sphericalElevation", -3, 3, {1, -3}), e57_integers("sphericalInvalidState", 0, 2, {0, 2}),
            e57_doubles("nor:normalX", {1, 0}), e57_doubles("nor:normalY", {0, 1}), e57_doubles("nor:normalZ", {0, 0})},
           "",
           512,
           false}};
}

/// PCD with two points of every kind of field; `data` is the word after DATA.
std::string pcd(const std::string& data) {
  const std::string header =
      "# .PCD v.7\nVERSION .7\nFIELDS x y z rgb normal_x normal_y normal_z ring\nSIZE 4 4 4 4 4 4 4 2\n"
      "TYPE F F F F F F F U\nCOUNT 1 1 1 1 1 1 1 2\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA " +
      data + "\n";
  if (data == "ascii") return header + "0 0 0 4.2e-39 0 0 1 3 4\n2 0.5 nan 0 0 1 0 5 6\n";
  const std::string points(2 * 32, '\1');
  if (data == "binary") return header + points;
  std::string packed;  // a literal, then copies of it
  packed += '\3' + points.substr(0, 4);
  packed += std::string("\xe0\x33\3", 3);
  std::string sizes;
  append(sizes, static_cast<std::uint32_t>(packed.size()));
  append(sizes, static_cast<std::uint32_t>(points.size()));
  return header + sizes + packed;
}

/// Options by their path, as --set takes them.
void add_settings(SeedFolder& seeds, char kind, const OptionNodes& nodes) {
  std::string lines(1, kind);
  for (const OptionRow& row : option_table(nodes)) {
    if (row.path.empty() || !row.method.empty()) continue;
    lines += row.path + "=" + row.default_value + "\n";
    if (lines.size() < 200) continue;
    seeds.add(lines);
    lines = kind;
  }
  seeds.add(lines);
}

}  // namespace

void write_mesh_seeds(const fs::path& all) {
  const test::ScratchFolder scratch;
  const TriMesh mesh = tetrahedron();
  const io::VertexColours colours(4, {200, 100, 50});
  const auto written = [&](io::MeshFormat format, std::span<const io::VertexScalar> scalars = {},
                           const io::VertexColours& c = {}) {
    io::write_mesh(mesh, scratch / "mesh", format, scalars, c);
    return read_bytes(scratch / "mesh");
  };
  SeedFolder ply(all, "ply"), stl(all, "stl"), obj(all, "obj"), off(all, "off"), las_seeds(all, "las"), glb(all, "glb");
  ply.add(written(io::MeshFormat::ply));
  ply.add(written(io::MeshFormat::ply, std::vector<io::VertexScalar>{{"thickness", {1, 2, 3, 4}}}, colours));
  ply.add(big_endian_ply());
  ply.add(
      "ply\nformat ascii 1.0\ncomment by hand\nobj_info none\nelement vertex 3\nproperty float x\n"
      "property double y\nproperty short z\nproperty float nx\nproperty float ny\nproperty float nz\n"
      "property uint scan\nelement face 1\nproperty list uchar int vertex_index\nelement edge 1\n"
      "property int vertex1\nproperty int vertex2\nend_header\n0 0 0 0 0 1 0\n1 0 0 0 0 1 0\n0 1 0 0 0 1 1\n"
      "3 0 1 2\n0 1\n");
  stl.add(written(io::MeshFormat::stl));
  stl.add(
      "solid by hand\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1e0 0\n"
      "  endloop\n endfacet\nfacet normal nan nan nan\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex -0.0 1 0\n"
      "endloop\nendfacet\nendsolid by hand\n");
  obj.add(written(io::MeshFormat::obj));
  obj.add(written(io::MeshFormat::obj, {}, colours));
  obj.add(
      "# by hand\nmtllib none.mtl\no one\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0 1.0\nv 1 1 3 0.1 0.2 0.3\nvt 0 0\n"
      "vn 0 0 1\ns off\nf 1 4 3 2\nf 1/1 2/1 5/1\nf -4//-1 -3//1 -1//1\nf 3/1/1 4/-1/-1 5/1/1\nl 1 2\np 1\n");
  off.add(written(io::MeshFormat::off));
  off.add(written(io::MeshFormat::off, {}, colours));
  off.add(
      "CNOFF 4 1 0\n# corners\n0 0 0 0 0 1 255 0 0\n2 0.5 0 0 1 0 0 1.0 0\n-2 2 1e-3 -1 0 0 0 0 255 9\n"
      "0 2 4 0.6 0 0.8 10 20 30\n4 0 3 2 1 0.5 0.5 0.5\n");
  SeedFolder pcd_seeds(all, "pcd"), ptx(all, "ptx");
  for (const char* data : {"ascii", "binary", "binary_compressed"}) pcd_seeds.add(pcd(data));
  const std::string pose = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7 1\n";
  ptx.add("2\n1\n" + pose + "1 2 3 0.5 255 0 9\n0 0 0 0.5 0 0 0\n");
  ptx.add("1\n2\n" + pose + "1 2 3 0.5\n-1 2e-3 3 0.5\n1\n1\n" + pose + "4 5 6 0.1\n");
  SeedFolder e57(all, "e57");
  for (const test::E57Scan& scan : e57_scans()) e57.add(test::e57_content({scan}));
  e57.add(test::e57_content(e57_scans()));
  for (int format = 0; format <= 10; ++format) las_seeds.add(las(format));
  for (const int format : {0, 1, 2, 3, 6, 7, 8}) las_seeds.add(small_laz(format));
  std::vector<io::LodSurface> levels(1);
  levels[0].name = "level1";
  levels[0].mesh = mesh;
  io::write_lod_glb(levels, scratch / "one.glb");
  glb.add(read_bytes(scratch / "one.glb"));
  levels[0].colours = colours;
  levels.emplace_back().name = "level2";
  levels[1].mesh = {mesh.vertices, {mesh.triangles[0]}};
  io::write_lod_glb(levels, scratch / "two.glb");
  glb.add(read_bytes(scratch / "two.glb"));
}

void write_text_seeds(const fs::path& all) {
  SeedFolder rows(all, "rows"), tracks(all, "tracks"), json(all, "json"), normals(all, "normals");
  for (const char* text :
       {"0 0 0\n\n2\t+0.5 0\n-2 2 1e-3 \n", "0 0 0 0 0 1\n2 0.5 0 0 1 0\n", "// seen\n0 0 0 255 0 0\n2 0.5 0 0 255 0\n",
        "# all\n0 0 0 255 0 0 0 0 1\n2 0 0 0 255 0 0 1 0\n",
        "2\n0 0 0 -17 255 0 0\n2 0.5 0 5 0 255 0\n1\n1 1 1 7 9 9 9\n", "0,0,0\n2,0.5,0\n-2, 2,1e-3\n",
        "\"X\";\"Y\";\"Z\";class;NX;NY;NZ;Red;Green;Blue;scan\n0;0;0;wall;0;0;1;255;0;0;1\n"})
    for (const char name : {'\0', '\1', '\2', '\3'}) rows.add(name + std::string(text));
  tracks.add("point,gate,x_mm,y_mm,z_mm\na,1,1,2,3\nb,1,0,0,1e-3\na,2,1,2,4\nb,2,-1,5,6\n");
  tracks.add("# tags\n\"Z\"; note; GATE; X; Y; Point\n3;far;2;1;2;p\n\n6; ;1;4;5;p\n9;x;1;7;8;q\n1;x;2;1;1;q\n");
  tracks.add("point gate x y z\na 1 0 0 0\na 2 0 0 1\nb 2 1 1 1\n");
  for (const char* text :
       {"{\"schema\": \"dynasurf.cloud/1\", \"levels\": [{\"name\": \"level1\", \"vertices\": 642}], \"out\": null}\n",
        "[0, -0, 1.5e-3, -2E+10, 18446744073709551615, -9223372036854775808, true, false, null, \"\"]",
        "{\"a\\u00e9\\ud83d\\ude00\\n\\\\\\/\\b\\f\\t\": {\"b\": [[], {}, [{}]]}, \"\": \"\xc3\xa9\xf0\x9f\x98\x80\"}",
        "7", "\"text\""})
    json.add(text);
  ventricle::NormalMap map;
  map.studies = 3;
  map.perfusion_is = ventricle::Perfusion::counts;
  map.mean.resize(map.grid.size());
  map.sd.resize(map.grid.size());
  map.mean[0] = 90.5, map.sd[0] = 7.25;
  normals.add('\0' + report::normals_text(map));
  normals.add("\1{\"1\": 0, \"7\": 4, \"17\": 2}");
  std::string polar = "\2{\"measures\": {\"perfusion_is\": \"counts\"}}----\narea_mm2,perfusion_percent\n2.5,90\n";
  for (std::size_t n = 1; n < map.grid.size(); ++n) polar += ",\n";
  normals.add(polar);
  normals.add('\0' + report::normal_groups_text({{"sex"}, 3, {{{"F"}, 3, map}, {{"M"}, 1, std::nullopt}}, map}));
}

void write_manifest_seeds(const fs::path& all) {
  SeedFolder seeds(all, "manifest");
  const std::string hash(64, 'a');
  seeds.add(io::manifest_text({}));
  seeds.add(io::unfinished_manifest_text());
  seeds.add(io::manifest_text({{"results.json", 12345, hash}, {"meshes/a b\xc3\xa9.ply", 0, hash}}));
}

void write_option_seeds(const fs::path& all) {
  SeedFolder options(all, "options"), settings(all, "settings");
  test::Toy toy;
  synthetic::PhantomOptions phantom;
  const ChoiceRef kinds = choice_of(phantom);
  for (std::size_t kind = 0; kind <= kinds.methods.size(); ++kind) {
    const bool is_toy = kind == kinds.methods.size();
    const OptionNodes nodes = is_toy ? nodes_of(toy) : kinds.choose(kind);
    const char byte = is_toy ? '\0' : static_cast<char>(2 * kind + 1);
    options.add(byte + io::options_to_text(nodes));
    add_settings(settings, byte, nodes);
  }
  options.add('\0' +
              std::string("{\"step\": {\"method\": \"edge\", \"gain\": 4}, \"limit\": null, \"colour\": \"blue\"}"));
  options.add('\0' + std::string("{\"step\": \"edge\", \"inner\": {\"depth\": -5}, \"seed\": 18446744073709551615}"));
  settings.add('\0' + std::string("step.method=edge\nstep.gain=7\nlimit=unset\ncolour=red\nlimit=5\nwidth_mm=1e1\n"));
}

}  // namespace dynasurf::fuzz
