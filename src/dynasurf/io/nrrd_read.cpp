#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "dynasurf/core/detail/letters.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/formats.hpp"
#include "dynasurf/io/detail/nrrd_header.hpp"
#include "dynasurf/io/detail/samples.hpp"

namespace dynasurf::io {
namespace {

namespace fs = std::filesystem;

SampleType sample_type(const NrrdHeader& header) {
  // Spellings of the definition of NRRD, blanks left out.
  static const std::map<std::string, SampleType> types = {{"signedchar", SampleType::int8},
                                                          {"int8", SampleType::int8},
                                                          {"int8_t", SampleType::int8},
                                                          {"uchar", SampleType::uint8},
                                                          {"unsignedchar", SampleType::uint8},
                                                          {"uint8", SampleType::uint8},
                                                          {"uint8_t", SampleType::uint8},
                                                          {"short", SampleType::int16},
                                                          {"shortint", SampleType::int16},
                                                          {"signedshort", SampleType::int16},
                                                          {"signedshortint", SampleType::int16},
                                                          {"int16", SampleType::int16},
                                                          {"int16_t", SampleType::int16},
                                                          {"ushort", SampleType::uint16},
                                                          {"unsignedshort", SampleType::uint16},
                                                          {"unsignedshortint", SampleType::uint16},
                                                          {"uint16", SampleType::uint16},
                                                          {"uint16_t", SampleType::uint16},
                                                          {"int", SampleType::int32},
                                                          {"signedint", SampleType::int32},
                                                          {"int32", SampleType::int32},
                                                          {"int32_t", SampleType::int32},
                                                          {"uint", SampleType::uint32},
                                                          {"unsignedint", SampleType::uint32},
                                                          {"uint32", SampleType::uint32},
                                                          {"uint32_t", SampleType::uint32},
                                                          {"longlong", SampleType::int64},
                                                          {"longlongint", SampleType::int64},
                                                          {"signedlonglong", SampleType::int64},
                                                          {"signedlonglongint", SampleType::int64},
                                                          {"int64", SampleType::int64},
                                                          {"int64_t", SampleType::int64},
                                                          {"ulonglong", SampleType::uint64},
                                                          {"unsignedlonglong", SampleType::uint64},
                                                          {"unsignedlonglongint", SampleType::uint64},
                                                          {"uint64", SampleType::uint64},
                                                          {"uint64_t", SampleType::uint64},
                                                          {"float", SampleType::float32},
                                                          {"double", SampleType::float64}};
  std::string name = small_letters(header.need("type"));
  std::erase(name, ' ');
  const auto it = types.find(name);
  if (it == types.end()) header.refuse("type", "a type of integer or real number");
  return it->second;
}

SampleLayout layout_of(const NrrdHeader& header) {
  SampleLayout layout;
  layout.type = sample_type(header);
  if (bytes_of(layout.type) > 1) {
    const std::string endian = small_letters(header.need("endian"));
    if (endian != "little" && endian != "big") header.refuse("endian", "little or big");
    layout.big_endian = endian == "big";
  }
  return layout;
}

ByteSource::Packing packing_of(const NrrdHeader& header) {
  const std::string encoding = small_letters(header.need("encoding"));
  if (encoding == "raw") return ByteSource::Packing::plain;
  if (encoding != "gzip" && encoding != "gz")
    header.refuse("encoding", "raw or gzip (convert it with: unu save -f nrrd -e gzip)");
  return ByteSource::Packing::gzip;
}

struct Axes {
  Index3 dims{};
  int gates = 1;
  int list_axis = -1;  // 0 or 3, -1: one volume
};

/// Words of `space directions`, one per axis: "none" or "(x,y,z)". Spaces inside the brackets are allowed.
std::vector<std::string> direction_words(const std::string& text) {
  std::string packed;
  int depth = 0;
  for (const char c : text) {
    depth += c == '(' ? 1 : c == ')' ? -1 : 0;
    if (depth > 0 && c == ' ') continue;
    packed += c;
    if (c == ')') packed += ' ';
  }
  return words(packed);
}

Vec3 vector_of(const NrrdHeader& header, const std::string& field, const std::string& word) {
  if (word.size() < 2 || word.front() != '(' || word.back() != ')') header.refuse(field, "vectors like (1,0,0)");
  Vec3 v;
  std::string_view rest = std::string_view(word).substr(1, word.size() - 2);
  for (int n = 0; n < 3; ++n) {
    const auto comma = rest.find(',');
    if ((comma == std::string_view::npos) != (n == 2)) header.refuse(field, "vectors of three numbers");
    v[n] = number_of<double>(header, field, rest.substr(0, comma));
    if (n < 2) rest.remove_prefix(comma + 1);
  }
  return v;
}

Axes axes_of(const NrrdHeader& header) {
  const auto sizes = words(header.need("sizes"));
  const auto rank = number_of<std::uint64_t>(header, "dimension", header.need("dimension"));
  if (rank != 3 && rank != 4) header.refuse("dimension", "3 (one volume) or 4 (gates)");
  if (sizes.size() != rank) header.refuse("sizes", std::to_string(rank) + " numbers");
  Axes axes;
  if (rank == 4) {
    axes.list_axis = 3;
    if (const auto directions = header.find("spacedirections")) {
      const auto vectors = direction_words(*directions);
      if (vectors.size() == 4 && vectors[0] == "none" && vectors[3] != "none") axes.list_axis = 0;
    } else if (const auto kinds = header.find("kinds")) {
      const auto names = words(small_letters(*kinds));
      if (!names.empty() && (names[0] == "list" || names[0] == "time")) axes.list_axis = 0;
    }
  }
  std::uint64_t extent[4] = {1, 1, 1, 1};
  std::size_t next = 0;
  for (std::size_t a = 0; a < rank; ++a) {
    const auto n = number_of<std::uint64_t>(header, "sizes", sizes[a]);
    (static_cast<int>(a) == axes.list_axis ? extent[3] : extent[next++]) = n;
  }
  check_study_size(extent[0], extent[1], extent[2], extent[3], header.where);
  for (std::size_t a = 0; a < 3; ++a) axes.dims[a] = extent[a];
  axes.gates = extent[3];
  if (const auto kinds = header.find("kinds")) {
    const auto names = words(small_letters(*kinds));
    if (names.size() != rank) header.refuse("kinds", "one word per axis");
    for (std::size_t a = 0; a < rank; ++a) {
      const bool listed = static_cast<int>(a) == axes.list_axis;
      const bool fits = names[a] == "none" || names[a] == "???" ||
                        (listed ? names[a] == "list" || names[a] == "time" || names[a] == "domain"
                                : names[a] == "domain" || names[a] == "space");
      if (!fits) header.refuse("kinds", "three domain axes and at most one list of gates, one value per voxel");
    }
  }
  return axes;
}

Vec3 to_lps_of(const NrrdHeader& header) {
  const std::string space = small_letters(header.need("space"));
  if (space == "left-posterior-superior" || space == "lps") return {1, 1, 1};
  if (space == "right-anterior-superior" || space == "ras") return {-1, -1, 1};
  if (space == "left-anterior-superior" || space == "las") return {1, -1, 1};
  header.refuse("space", "left-posterior-superior, right-anterior-superior or left-anterior-superior");
}

double millimetres_per_unit(const NrrdHeader& header) {
  const auto units = header.find("spaceunits");
  if (!units) return 1;
  const auto names = quoted(*units);
  for (const std::string& name : names)
    if (name != names.front()) header.refuse("spaceunits", "the same unit three times");
  if (names.size() != 3) header.refuse("spaceunits", "three quoted units");
  const std::string& unit = names.front();
  if (unit == "mm" || unit.empty() || unit == "???") return 1;
  if (unit == "cm") return 10;
  if (unit == "m") return 1000;
  if (unit == "um") return 0.001;
  header.refuse("spaceunits", "\"mm\" \"mm\" \"mm\"");
}

/// A header without a space: voxel sizes at best, but nothing of where left and right are.
Grid unplaced_grid(const NrrdHeader& header, const Axes& axes, Notes& notes) {
  Mat3 steps = Mat3::Identity();
  const auto spacings = words(header.need("spacings"));
  int next = 0;
  for (std::size_t a = 0; a < spacings.size(); ++a)
    if (static_cast<int>(a) != axes.list_axis && next < 3) {
      steps(next, next) = number_of<double>(header, "spacings", spacings[a]);
      ++next;
    }
  if (next != 3) header.refuse("spacings", "one number per axis");
  notes.push_back({Severity::warning, "nrrd.no_orientation",
                   "the file names no space: where left and right are is assumed, not known"});
  return grid_from_steps(axes.dims, steps, Vec3::Zero(), header.where);
}

Grid grid_of(const NrrdHeader& header, const Axes& axes, Notes& notes) {
  if (!header.find("spacedirections")) return unplaced_grid(header, axes, notes);
  const Vec3 to_lps = to_lps_of(header) * millimetres_per_unit(header);
  const auto vectors = direction_words(header.need("spacedirections"));
  if (vectors.size() != (axes.list_axis < 0 ? 3u : 4u)) header.refuse("spacedirections", "one vector per axis");
  Mat3 steps;
  int next = 0;
  for (std::size_t a = 0; a < vectors.size(); ++a) {
    if (static_cast<int>(a) == axes.list_axis) {
      if (vectors[a] != "none" && vectors[a] != "(nan,nan,nan)")
        header.refuse("spacedirections", "none for the axis of the gates");
      continue;
    }
    steps.col(next++) = to_lps.cwiseProduct(vector_of(header, "spacedirections", vectors[a]));
  }
  Vec3 origin = Vec3::Zero();
  if (const auto text = header.find("spaceorigin")) {
    const auto vector = direction_words(*text);
    if (vector.size() != 1) header.refuse("spaceorigin", "one vector");
    origin = to_lps.cwiseProduct(vector_of(header, "spaceorigin", vector[0]));
  } else {
    notes.push_back({Severity::warning, "nrrd.no_origin", "the file gives no space origin: zero is assumed"});
  }
  return grid_from_steps(axes.dims, steps, origin, header.where);
}

/// The unit of the gate axis in ms, 0 when the file does not say.
double gate_unit_ms(const NrrdHeader& header, int list_axis) {
  const auto units = header.find("units");
  if (!units) return 0;
  const auto names = quoted(*units);
  if (names.size() != 4) return 0;
  const std::string& unit = names[list_axis];
  return unit == "ms" ? 1 : unit == "s" ? 1000 : unit == "us" ? 0.001 : 0;
}

/// Times of the gates from Slicer's sequence keys.
void set_times(Study& study, const NrrdHeader& header, int list_axis) {
  if (study.gates.size() < 2) return;
  const std::string key = "axis " + std::to_string(list_axis) + " index values";
  const double unit_ms = gate_unit_ms(header, list_axis);
  std::vector<double> times;
  if (const auto it = header.keys.find(key); it != header.keys.end() && unit_ms > 0)
    for (const std::string& word : words(it->second)) {
      double value = 0;
      const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
      if (error != std::errc{} || rest != word.data() + word.size() || !std::isfinite(value)) {
        times.clear();
        break;
      }
      times.push_back(value * unit_ms);
    }
  // less_equal: two gates at one time are no order.
  const bool ordered = std::is_sorted(times.begin(), times.end(), std::less_equal<>());
  if (times.size() != study.gates.size() || !ordered || times.back() - times.front() > 3000) times.clear();
  bool uniform = times.size() > 1;
  for (std::size_t g = 2; g < times.size(); ++g)
    uniform = uniform && std::abs(times[g] - times[g - 1] - (times[1] - times[0])) < 1e-3 * (times[1] - times[0]);
  if (uniform || times.empty()) {
    const double step = times.empty() ? 0 : (times.back() - times.front()) / (times.size() - 1);
    set_uniform_times(study, times.empty() ? 0 : times.front(), step, "nrrd.no_gate_times");
    return;
  }
  study.time_ms = times;
}

/// What our own writer adds beside the standard.
void set_own_keys(Study& study, const NrrdHeader& header) {
  const auto value = [&](const char* key) {
    const auto it = header.keys.find(key);
    return it == header.keys.end() ? std::string() : it->second;
  };
  for (const View v : {View::short_axis, View::horizontal_long_axis, View::vertical_long_axis, View::transaxial})
    if (value("dynasurf view") == name_of(v)) study.view = v;
  for (const SliceOrder o : {SliceOrder::apex_to_base, SliceOrder::base_to_apex})
    if (value("dynasurf slice order") == name_of(o)) study.slice_order = o;
  for (const Attenuation a : {Attenuation::uncorrected, Attenuation::corrected})
    if (value("dynasurf attenuation") == name_of(a)) study.attenuation = a;
  const std::string cycle = value("dynasurf cycle ms");
  double ms = 0;
  const auto [rest, error] = std::from_chars(cycle.data(), cycle.data() + cycle.size(), ms);
  if (!cycle.empty() && error == std::errc{} && rest == cycle.data() + cycle.size() && ms >= 200 && ms <= 3000)
    study.cycle_ms = ms;
}

/// The number of a key that Slicer writes for a segment; `otherwise` where it is absent.
int number_of_segment(const NrrdHeader& header, std::size_t segment, const char* name, int otherwise, int most) {
  const std::string key = "Segment" + std::to_string(segment) + name;
  const auto it = header.keys.find(key);
  if (it == header.keys.end()) return otherwise;
  int value = 0;
  const auto [rest, error] = std::from_chars(it->second.data(), it->second.data() + it->second.size(), value);
  if (error != std::errc{} || rest != it->second.data() + it->second.size() || value < 0 || value > most)
    throw InputError(header.where + ": NRRD key " + key + " is \"" + it->second.substr(0, 40) + "\"; expected 0 to " +
                     std::to_string(most));
  return value;
}

/// A segmentation of Slicer's (.seg.nrrd) becomes one label map. Segments that overlap stand in layers, one volume
/// each; where two have the same value they are numbered, and the later one covers the earlier.
void read_segmentation(Study& study, const NrrdHeader& header) {
  const auto has_segment = [&](std::size_t n) { return header.keys.count("Segment" + std::to_string(n) + "_ID") > 0; };
  if (!has_segment(0)) return;
  const int layers = study.gates.size();
  std::map<std::pair<int, float>, int> segments;  // layer and value -> number from 1
  std::map<int, int> values;                      // value -> how many segments have it
  int count = 0;
  for (std::size_t n = 0; has_segment(n); ++n) {
    // Files of before 2020 have a layer per segment and tell neither layer nor value.
    const int usual = layers > 1 ? std::min(static_cast<int>(n), layers - 1) : 0;
    const int layer = number_of_segment(header, n, "_Layer", usual, layers - 1);
    const int value = number_of_segment(header, n, "_LabelValue", 1, 65535);
    segments[{layer, static_cast<float>(value)}] = ++count;
    ++values[value];
  }
  const bool keeps_values =
      layers == 1 || std::all_of(values.begin(), values.end(), [](const auto& v) { return v.second == 1; });
  if (layers > 1) {
    std::vector<int> top(study.grid().size(), 0);  // the last segment of each voxel
    for (int layer = 0; layer < layers; ++layer) {
      Image& image = study.gates[layer];
      for (std::size_t v = 0; v < top.size(); ++v) {
        if (image.values[v] == 0) continue;
        const auto it = segments.find({layer, image.values[v]});
        if (it == segments.end() || it->second < top[v]) continue;
        top[v] = it->second;
        study.gates[0].values[v] = keeps_values ? image.values[v] : it->second;
      }
    }
    for (std::size_t v = 0; v < top.size(); ++v)
      if (top[v] == 0) study.gates[0].values[v] = 0;
    study.gates.resize(1);
  }
  study.notes.push_back(
      {Severity::info, "nrrd.segmentation",
       "the file is a segmentation of " + std::to_string(count) + (count == 1 ? " segment" : " segments") +
           (layers > 1 ? " in " + std::to_string(layers) + " layers, read as one label map" : ", a label map") +
           (keeps_values ? "" : " with the segments numbered from 1") +
           ": a mask, or a study of which --label names the muscle"});
}

/// The data file, which has to be in the folder of the header, also when it is a link.
fs::path data_file_beside(const fs::path& header, const std::string& name) {
  fs::path file = header.parent_path() / name;
  std::error_code error;
  if (!fs::is_symlink(file, error)) return file;
  const fs::path here = fs::canonical(header.parent_path().empty() ? "." : header.parent_path(), error);
  const fs::path there = fs::canonical(file, error);
  if (error || there.parent_path() != here)
    throw InputError(file.string() + ": is a link that leads out of the folder of its header " +
                     header.filename().string());
  return file;
}

std::optional<std::string> data_file_name(const NrrdHeader& header) {
  const auto long_name = header.find("datafile");
  if (!long_name) return std::nullopt;
  const std::string& name = *long_name;
  if (name.empty() || name == "LIST" || name.find('%') != std::string::npos)
    header.refuse("datafile", "the name of one file");
  // A header must not be able to point at other files of the machine.
  if (name.find('/') != std::string::npos || name == "." || name == "..")
    header.refuse("datafile", "a name in the folder of the header, without a path");
  return name;
}

/// Offset of the voxels in the file that holds them.
std::uint64_t data_offset(const NrrdHeader& header, const fs::path& file, std::uint64_t start, std::uint64_t bytes,
                          ByteSource::Packing packing) {
  const auto lines = number_of<std::int64_t>(header, "lineskip", header.find("lineskip").value_or("0"));
  const auto skip = number_of<std::int64_t>(header, "byteskip", header.find("byteskip").value_or("0"));
  if (lines < 0 || skip < -1)
    header.refuse(lines < 0 ? "lineskip" : "byteskip", "a number of lines or bytes to leave out");
  if (lines == 0 && skip == 0) return start;
  if (packing != ByteSource::Packing::plain)
    throw InputError(header.where + ": line skip and byte skip are read for raw encoding only");
  const std::uint64_t size = size_of_file(file);
  if (skip == -1) {
    if (size < start || size - start < bytes)
      throw InputError(file.string() + ": is cut off: " + std::to_string(bytes) + " bytes of voxels are declared");
    // Counted from the end, the voxels of a shorter file would all be shifted, and nobody could tell.
    if (size - start > bytes)
      header.refuse("byteskip", "how many bytes stand before the voxels, so that a file that was cut is told from a " +
                                    ("whole one: " + std::to_string(size - start - bytes)) + " if this one is whole");
    return start;
  }
  ByteSource source(file, packing, start);
  std::uint64_t offset = start;
  for (std::int64_t seen = 0; seen < lines; ++offset) {
    std::byte byte{};
    source.read({&byte, 1}, "lines before the voxels");
    seen += byte == std::byte{'\n'};
  }
  return offset + skip;
}

}  // namespace

std::vector<std::filesystem::path> data_files_of_nrrd(const std::filesystem::path& path) {
  const auto name = data_file_name(read_nrrd_header(path));
  if (!name) return {};
  return {data_file_beside(path, *name)};
}

Study read_nrrd(const std::filesystem::path& path) {
  const NrrdHeader header = read_nrrd_header(path);
  const Axes axes = axes_of(header);
  SampleLayout layout = layout_of(header);
  layout.gate_fastest = axes.list_axis == 0;
  const ByteSource::Packing packing = packing_of(header);

  Study study;
  study.format = "NRRD";
  const Grid grid = grid_of(header, axes, study.notes);
  const auto name = data_file_name(header);
  if (!name && !header.has_blank_line)
    throw InputError(header.where + ": the NRRD header ends without a blank line, so no voxels follow");
  const fs::path file = name ? data_file_beside(path, *name) : path;
  const std::uint64_t bytes = std::uint64_t{bytes_of(layout.type)} * grid.size() * axes.gates;
  ByteSource source(file, packing, data_offset(header, file, name ? 0 : header.end, bytes, packing));
  study.gates = read_samples(source, grid, axes.gates, layout, file.string(), study.notes);
  read_segmentation(study, header);
  set_times(study, header, axes.list_axis);
  set_own_keys(study, header);
  return study;
}

}  // namespace dynasurf::io
