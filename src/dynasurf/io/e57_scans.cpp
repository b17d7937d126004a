#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <new>

#include <pugixml.hpp>

#include "dynasurf/core/detail/memory_limit.hpp"
#include "dynasurf/io/detail/e57_parts.hpp"

// The XML text of an E57 file, which tells where the points of each scan stand and what they look like.

namespace dynasurf::io::detail::e57 {
namespace {

constexpr std::size_t most_columns = 1024;
constexpr std::uint64_t longest_xml = std::uint64_t{64} << 20;

constexpr const char* role_names[] = {"cartesianX",
                                      "cartesianY",
                                      "cartesianZ",
                                      "sphericalRange",
                                      "sphericalAzimuth",
                                      "sphericalElevation",
                                      "nor:normalX",
                                      "nor:normalY",
                                      "nor:normalZ",
                                      "colorRed",
                                      "colorGreen",
                                      "colorBlue",
                                      "cartesianInvalidState",
                                      "sphericalInvalidState",
                                      "isColorInvalid"};

class XmlText {
 public:
  explicit XmlText(Pages& pages) : pages_(pages) {
    const auto length = pages.number<std::uint64_t>(32);
    begin_ = pages.content_at(pages.number<std::uint64_t>(24), 24);
    if (length > pages.size() - begin_)
      pages.fail(32, "the XML has " + std::to_string(length) + " bytes; the file ends before");
    if (length > longest_xml)
      pages.fail(32, "the XML has " + std::to_string(length) + " bytes; expected at most 64 MiB");
    // The shortest element, of four bytes, becomes a node of 64.
    require_memory(pages.file().bytes.size() + 20 * length, pages.file().name, "its XML");
    text_.resize(static_cast<std::size_t>(length));
    pages.read(begin_, text_);
    const auto result = tree_.load_buffer_inplace(text_.data(), text_.size(), pugi::parse_default, pugi::encoding_utf8);
    if (result.status == pugi::status_out_of_memory) throw std::bad_alloc();
    if (!result) pages.fail(begin_ + static_cast<std::size_t>(result.offset), "the XML is not well formed");
    if (!root()) pages.fail(begin_, "the XML has no e57Root");
  }

  pugi::xml_node root() const { return tree_.child("e57Root"); }
  std::size_t place(pugi::xml_node node) const { return begin_ + static_cast<std::size_t>(node.offset_debug()); }
  [[noreturn]] void fail(pugi::xml_node node, const std::string& reason) const { pages_.fail(place(node), reason); }

  template <class T>
  T number_of(pugi::xml_node node, std::string_view text) const {
    const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
    while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
    std::string_view digits = text;
    if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
    T value{};
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    bool is_number = error == std::errc{} && end == digits.data() + digits.size();
    if constexpr (std::is_floating_point_v<T>) is_number = is_number && std::isfinite(value);
    if (!is_number) fail(node, quoted(text) + " stands in " + quoted(node.name()) + "; expected a number");
    return value;
  }
  template <class T>
  T attribute(pugi::xml_node node, const char* name, T without) const {
    const pugi::xml_attribute found = node.attribute(name);
    return found ? number_of<T>(node, found.value()) : without;
  }
  /// The number in an element; 0 when it is empty, and without the element.
  double value(pugi::xml_node node) const {
    const std::string_view text = node.child_value();
    const double number = text.empty() ? 0 : number_of<double>(node, text);
    if (std::string_view(node.attribute("type").value()) != "ScaledInteger") return number;
    return number * attribute(node, "scale", 1.0) + attribute(node, "offset", 0.0);
  }

 private:
  Pages& pages_;
  std::size_t begin_ = 0;
  std::string text_;
  pugi::xml_document tree_;
};

/// How much larger `most` is than `least`.
std::uint64_t span_of(std::int64_t least, std::int64_t most) {
  if (least >= 0 || most < 0) return static_cast<std::uint64_t>(most - least);
  return static_cast<std::uint64_t>(most) + static_cast<std::uint64_t>(-(least + 1)) + 1;
}

Column read_column(const XmlText& xml, pugi::xml_node node) {
  Column column;
  const auto name = std::find(std::begin(role_names), std::end(role_names), std::string_view(node.name()));
  column.role = static_cast<Role>(name - std::begin(role_names));
  const std::string_view type = node.attribute("type").value();
  if (type == "String") {
    column.kind = Column::Kind::text;
    column.role = Role::other;
    column.bits = 8;  // at least: how long it is
  } else if (type == "Float") {
    const bool is_single = std::string_view(node.attribute("precision").value()) == "single";
    column.kind = is_single ? Column::Kind::single : Column::Kind::real;
    column.bits = is_single ? 32 : 64;
    column.span = is_single ? 0xFFFFFFFFu : ~std::uint64_t{0};
  } else if (type == "Integer" || type == "ScaledInteger") {
    using Limits = std::numeric_limits<std::int64_t>;
    column.kind = Column::Kind::integer;
    column.least = xml.attribute(node, "minimum", Limits::min());
    const auto most = xml.attribute(node, "maximum", Limits::max());
    if (most < column.least) xml.fail(node, "the maximum of a column is below its minimum");
    column.span = span_of(column.least, most);
    column.bits = static_cast<unsigned>(std::bit_width(column.span));
    if (type == "ScaledInteger") {
      column.scale = xml.attribute(node, "scale", 1.0);
      column.offset = xml.attribute(node, "offset", 0.0);
    }
  } else {
    xml.fail(node, "a column of type " + quoted(type) + "; expected Float, Integer, ScaledInteger or String");
  }
  return column;
}

std::vector<Column> read_columns(const XmlText& xml, pugi::xml_node prototype) {
  std::vector<Column> columns;
  std::array<bool, std::size(role_names)> is_there{};
  for (const pugi::xml_node node : prototype.children()) {
    if (node.type() != pugi::node_element) continue;
    if (columns.size() == most_columns) xml.fail(node, "the points have more than 1024 columns");
    const Column& column = columns.emplace_back(read_column(xml, node));
    if (column.role == Role::other) continue;
    bool& known = is_there[static_cast<std::size_t>(column.role)];
    if (known) xml.fail(node, "column " + quoted(node.name()) + " is there twice");
    known = true;
  }
  return columns;
}

/// Where the colours end that are black and full; of integers, unless it is told, where their column ends.
std::array<double, 2> colour_limits(const XmlText& xml, pugi::xml_node scan, pugi::xml_node column,
                                    const std::string& name) {
  const pugi::xml_node limits = scan.child("colorLimits");
  const pugi::xml_node least = limits.child((name + "Minimum").c_str()),
                       most = limits.child((name + "Maximum").c_str());
  std::array<double, 2> range{};
  if (least && most) {
    range = {xml.value(least), xml.value(most)};
  } else if (std::string_view(column.attribute("type").value()) != "Float") {
    const Column c = read_column(xml, column);
    const double low = static_cast<double>(c.least), high = low + static_cast<double>(c.span);
    range = {low * c.scale + c.offset, high * c.scale + c.offset};
  } else if (column.attribute("minimum") && column.attribute("maximum")) {
    range = {xml.attribute(column, "minimum", 0.0), xml.attribute(column, "maximum", 0.0)};
  } else {
    xml.fail(column, "real colours have no limits; expected colorLimits");
  }
  if (!(range[0] <= range[1]) || !std::isfinite(range[1] - range[0]))
    xml.fail(column, "the limits of a colour are not in order");
  return range;
}

void read_pose(const XmlText& xml, pugi::xml_node pose, Scan& scan) {
  const pugi::xml_node turn = pose.child("rotation"), way = pose.child("translation");
  scan.translation = {xml.value(way.child("x")), xml.value(way.child("y")), xml.value(way.child("z"))};
  if (!turn) return;
  const double w = xml.value(turn.child("w"));
  const Vec3 v(xml.value(turn.child("x")), xml.value(turn.child("y")), xml.value(turn.child("z")));
  const double length2 = w * w + v.squaredNorm();
  constexpr double most_off = 1e-3;  // more than rounding to single precision does
  if (!(std::abs(length2 - 1) <= most_off)) xml.fail(turn, "the rotation of a scan is no unit quaternion");
  Mat3 cross;
  cross << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  scan.rotation = Mat3::Identity() + 2 / length2 * (w * cross + cross * cross);
}

void refuse_codecs(const XmlText& xml, pugi::xml_node codecs) {
  for (const pugi::xml_node codec : codecs.children())
    for (const pugi::xml_node part : codec.children())
      if (const std::string_view name = part.name();
          part.type() == pugi::node_element && name != "inputs" && name != "bitPackCodec")
        xml.fail(part, "the points are packed with " + quoted(name) + "; expected bitPackCodec");
}

Scan read_scan(const XmlText& xml, pugi::xml_node node) {
  const pugi::xml_node points = node.child("points"), prototype = points.child("prototype");
  if (std::string_view(points.attribute("type").value()) != "CompressedVector")
    xml.fail(node, "a scan has no points of type CompressedVector");
  Scan scan;
  scan.told_at = xml.place(points);
  scan.section = xml.attribute(points, "fileOffset", std::uint64_t{0});
  const auto records = xml.attribute(points, "recordCount", std::uint64_t{0});
  if (records > most_cloud_points)
    xml.fail(points, "holds " + std::to_string(records) + " points; expected at most 100000000");
  scan.records = static_cast<std::size_t>(records);
  if (records == 0) return scan;
  refuse_codecs(xml, points.child("codecs"));
  scan.columns = read_columns(xml, prototype);
  if (!scan.has(Role::x) && !scan.has(Role::range))
    xml.fail(points,
             "the columns are no coordinates; expected cartesianX, Y and Z or sphericalRange, Azimuth and "
             "Elevation");
  if (scan.has(Role::red)) {
    const char* names[] = {"colorRed", "colorGreen", "colorBlue"};
    for (std::size_t c = 0; c < 3; ++c)
      scan.colour_limits[c] = colour_limits(xml, node, prototype.child(names[c]), names[c]);
  }
  if (const pugi::xml_node pose = node.child("pose")) {
    scan.has_pose = true;
    read_pose(xml, pose, scan);
  }
  return scan;
}

}  // namespace

bool Scan::has(Role first) const {
  const auto begin = static_cast<unsigned>(first);
  return std::count_if(columns.begin(), columns.end(), [&](const Column& c) {
           const auto role = static_cast<unsigned>(c.role);
           return role >= begin && role < begin + 3;
         }) == 3;
}

std::vector<Scan> read_scans(Pages& pages) {
  const XmlText xml(pages);
  std::vector<Scan> scans;
  for (const pugi::xml_node node : xml.root().child("data3D").children("vectorChild"))
    if (Scan scan = read_scan(xml, node); scan.records > 0) scans.push_back(std::move(scan));
  return scans;
}

}  // namespace dynasurf::io::detail::e57
