#include "dynasurf/cohort/detail/cohort_page.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <nlohmann/json.hpp>

#include "dynasurf/cohort/detail/job_key.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/png.hpp"
#include "dynasurf/report/detail/page_parts.hpp"
#include "dynasurf/report/detail/page_template.hpp"

namespace dynasurf::cohort {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t most_pictures = 200;

/// Few digits: the page shows no more, and ten thousand studies shall load fast.
Json rounded(const std::optional<double>& value) {
  if (!value || !std::isfinite(*value)) return nullptr;
  return std::round(*value * 100) / 100;
}

Json rounded(const std::vector<std::optional<double>>& values, double step) {
  Json list = Json::array();
  for (const auto& value : values)
    list.push_back(value && std::isfinite(*value) ? Json(std::round(*value / step) * step) : Json());
  return list;
}

/// How much a study asks to be looked at: no result, not trustworthy, to be checked with many flags, the others.
int concern_of(const CohortCase& one) {
  if (!one.status) return 1;
  if (!one.has_result()) return 4000;
  const int flags = std::min<std::size_t>(one.flags.size(), 99);
  return (one.status->verdict == "fail" ? 3000 : one.status->verdict == "check" ? 2000 : 100) + flags;
}

/// Half as wide and high, each pixel the mean of four.
io::Picture halved(const io::Picture& picture) {
  io::Picture half(picture.width / 2, picture.height / 2);
  for (int y = 0; y < half.height; ++y)
    for (int x = 0; x < half.width; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        const int sum = picture(2 * x, 2 * y)[c] + picture(2 * x + 1, 2 * y)[c] + picture(2 * x, 2 * y + 1)[c] +
                        picture(2 * x + 1, 2 * y + 1)[c];
        half(x, y)[c] = sum / 4;
      }
  return half;
}

/// The slices of a study as PNG in base64; null where it has no such picture.
Json picture_of(const Cohort& cohort, const CohortCase& one) {
  if (!one.has_result()) return nullptr;
  try {
    const io::Picture picture = io::read_png(result_folder(cohort.folder, one.study.id) / "measures" / "splash.png");
    // A folder may hold any picture under this name.
    if (picture.width < 2 || picture.height < 2 || picture.width > 4000 || picture.height > 4000) return nullptr;
    const std::string png = io::encode_png(halved(picture));
    return report::detail::base64({png.begin(), png.end()});
  } catch (const std::runtime_error&) {
    return nullptr;
  }
}

Json study_json(const CohortCase& one, const fs::path& published, const fs::path& cohort) {
  Json json = Json::object();
  json["id"] = one.study.id;
  json["groups"] = one.study.groups;
  json["state"] = !one.status ? "not_run" : one.has_result() ? "done" : "failed";
  json["verdict"] = one.status ? one.status->verdict : "";
  json["reason"] = one.status ? one.status->reason : "";
  json["flags"] = one.flags;
  if (const ReaderDecision& by = one.manual; !by.decision.empty() || !by.reader.empty() || !by.comment.empty())
    json["manual"] = {{"decision", by.decision}, {"reader", by.reader}, {"comment", by.comment}};
  json["concern"] = concern_of(one);
  json["wall_s"] = one.status ? rounded(one.status->wall_s) : Json();
  json["numbers"] = Json::array();
  for (const auto& number : one.numbers) json["numbers"].push_back(rounded(number));
  json["perfusion"] = rounded(one.perfusion, 1);
  json["curve"] = rounded(one.curve_ml, 0.1);
  json["report"] = one.has_result() ? report_link(published, cohort, one.study.id) : "";
  return json;
}

Json statistic_json(const StatisticRow& row) {
  const auto number = [](const std::optional<double>& v) { return v && std::isfinite(*v) ? Json(*v) : Json(); };
  return {row.statistic,
          row.of,
          row.against,
          row.group,
          row.n,
          row.left_out,
          number(row.value.value),
          number(row.value.low),
          number(row.value.high)};
}

/// The numbers of the other cohort, in the order of this one's studies.
Json second_json(const Cohort& cohort, const Cohort& second) {
  std::map<std::string, const CohortCase*> cases;
  for (const CohortCase& one : second.cases) cases[one.study.id] = &one;
  Json list = Json::array();
  for (const CohortCase& one : cohort.cases) {
    const auto other = cases.find(one.study.id);
    Json numbers = Json::array();
    if (other != cases.end())
      for (const auto& number : other->second->numbers) numbers.push_back(rounded(number));
    list.push_back(std::move(numbers));
  }
  return list;
}

/// A path as it stands in an address.
std::string as_address(const std::string& path) {
  constexpr char digits[] = "0123456789ABCDEF";
  std::string address;
  for (const unsigned char c : path)
    if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' || c == '-' ||
        c == '_' || c == '.' || c == '~')
      address += c;
    else
      address += {'%', digits[c >> 4], digits[c & 15]};
  return address;
}

}  // namespace

std::string report_link(const fs::path& tables, const fs::path& cohort, const std::string& id) {
  const fs::path from = fs::weakly_canonical(fs::absolute(tables)), to = fs::weakly_canonical(fs::absolute(cohort));
  const fs::path folder = result_folder(to, id);
  std::error_code unknown;
  const char* page = fs::is_regular_file(folder / "live.html", unknown) ? "live.html" : "report.html";
  return as_address((folder / page).lexically_relative(from).generic_string());
}

void write_cohort_page(const Cohort& cohort, const std::vector<StatisticRow>& statistics, const Cohort* second,
                       const std::filesystem::path& published, const std::filesystem::path& path) {
  Json data = Json::object();
  data["groups"] = cohort.group_columns;
  data["keys"] = Json::array();
  for (const KeyNumber& key : ventricle_key_numbers()) data["keys"].push_back({key.name, key.title, key.unit});
  data["studies"] = Json::array();
  std::vector<const CohortCase*> worst;
  for (const CohortCase& one : cohort.cases) {
    data["studies"].push_back(study_json(one, published, cohort.folder));
    worst.push_back(&one);
  }
  std::stable_sort(worst.begin(), worst.end(),
                   [](const auto* a, const auto* b) { return concern_of(*a) > concern_of(*b); });
  data["pictures"] = Json::object();
  for (const CohortCase* one : worst) {
    if (data["pictures"].size() >= most_pictures) break;
    if (Json picture = picture_of(cohort, *one); !picture.is_null())
      data["pictures"][one->study.id] = std::move(picture);
  }
  data["statistics"] = Json::array();
  for (const StatisticRow& row : statistics) data["statistics"].push_back(statistic_json(row));
  data["second"] = second ? second_json(cohort, *second) : Json();
  io::write_file(path, report::detail::filled_page(report::cohort_page_template(), data));
}

}  // namespace dynasurf::cohort
