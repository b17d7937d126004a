#include "dynasurf/show/detail/border_sheets.hpp"

#include <nlohmann/json.hpp>

#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/show/detail/sheets.hpp"

namespace dynasurf::show {
namespace {

/// "canny sigma_px 1.0 low 0.15 ..." for the title of a sheet.
std::string words_of(const nlohmann::ordered_json& options) {
  std::string text;
  for (const auto& [key, value] : options.items()) {
    if (!text.empty()) text += ", ";
    if (key == "method")
      text += value.get<std::string>();
    else
      text += key + " " +
              (value.is_object()   ? "(" + words_of(value) + ")"
               : value.is_string() ? value.get<std::string>()
                                   : value.dump());
  }
  return text;
}

std::string title_of(const std::string& subject, const ventricle::Options& options, bool labels) {
  const auto json = io::parse_json(io::options_to_text(options), "the options");
  return subject + ": " + words_of(labels ? json.at("labels").at("method") : json.at("edges"));
}

}  // namespace

void write_border_sheets(const ventricle::BorderResult& result, const ventricle::Options& options, bool labels,
                         const std::filesystem::path& folder) {
  const ventricle::RadialLabels* asked = std::get_if<ventricle::RadialLabels>(&options.labels.method);
  for (std::size_t g = 0; g < result.gates.size(); ++g) {
    const ventricle::GateBorders& gate = result.gates[g];
    const Image& image = result.study.gates[g];
    const std::string prefix = (folder / ((g < 9 ? "g0" : "g") + std::to_string(g + 1))).string();
    const std::string subject = "gate " + std::to_string(g + 1) + " of " + std::to_string(result.gates.size());
    const auto write = [&](const Canvas& sheet, const char* kind) {
      write_drawing(sheet, prefix + "_" + kind + ".png", DrawingFormat::png);
    };
    write(draw_edges(image, gate.edges, title_of(subject, options, false)), "edges");
    if (!labels) continue;
    write(draw_labels(image, gate, result.coarse, title_of(subject, options, true)), "labels");
    write(draw_rings(image, gate, asked ? *asked : ventricle::RadialLabels{}, subject + ": edge voxels by distance"),
          "rings");
  }
}

}  // namespace dynasurf::show
