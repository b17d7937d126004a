// Virtual patients through the whole pipeline, without help: the series of two hundred, the same in large fields of
// view, and with failures planted. Prints one line per patient and tables.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "examine.hpp"
#include "failures.hpp"

namespace dynasurf {
namespace {

void print_line(const Outcome& o) {
  const synthetic::VirtualPatient& p = o.patient.options;
  std::printf(
      "%3d %s%s def=%-12s gut=%d rv=%.1f edv=%3.0f ef=%2.0f fwhm=%4.1f px=%.1f sl=%.1f g=%2d n=%3.0f | %s %s ef%+6.1f "
      "(90: %.1f) edv x%.2f axis %5.1f centre %5.1f across %4.1f base %5.1f div %4.1f border %4.1f/%4.1f | %s | %s\n",
      o.patient.number, o.kind.empty() ? "" : (o.kind + " ").c_str(), o.patient.oblique ? "oblique" : "short  ",
      std::string(word_of(p.defect)).c_str(), p.gut_amplitude > 0 ? 1 : 0, p.right_ventricle, p.edv_ml, p.ef_percent,
      p.fwhm_mm, p.lattice.dx_mm, p.lattice.dz_mm, p.gates, p.noise.peak_counts, o.wrong() ? "WRONG" : "right",
      std::string(word_of(o.verdict)).c_str(), o.ef_error, o.ef_90, o.edv_ratio, o.axis_deg, o.centre_mm, o.across_mm,
      o.base_mm, o.division, o.border_mm, o.allowed_mm, o.clues.c_str(), o.flags.c_str());
  std::fflush(stdout);
}

using Rows = std::vector<Outcome>;

double quantile(std::vector<double> v, double share) {
  if (v.empty()) return NAN;
  std::sort(v.begin(), v.end());
  return v[static_cast<std::size_t>(std::lround(share * static_cast<double>(v.size() - 1)))];
}

double share_of(const Rows& rows, const std::function<bool(const Outcome&)>& is) {
  return rows.empty() ? NAN
                      : 100.0 * static_cast<double>(std::count_if(rows.begin(), rows.end(), is)) /
                            static_cast<double>(rows.size());
}

Rows part_of(const Rows& rows, const std::function<bool(const Outcome&)>& is) {
  Rows part;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(part), is);
  return part;
}

void print_table(const char* title, const Rows& rows) {
  if (rows.empty()) return;
  const auto all = [&](double Outcome::*member) {
    std::vector<double> v;
    for (const Outcome& o : rows) v.push_back(o.*member);
    return v;
  };
  const Rows wrong = part_of(rows, [](const Outcome& o) { return o.wrong(); });
  const Rows right = part_of(rows, [](const Outcome& o) { return !o.wrong(); });
  const Rows known = part_of(rows, [](const Outcome& o) { return o.has_surfaces; });
  std::vector<double> ef, absolute;
  for (const Outcome& o : known) ef.push_back(o.ef_error), absolute.push_back(std::abs(o.ef_error));
  double mean = 0, square = 0;
  for (double e : ef) mean += e / static_cast<double>(ef.size());
  for (double e : ef) square += (e - mean) * (e - mean) / static_cast<double>(ef.size());
  const auto flagged = [](const Outcome& o) { return o.flagged(); };
  std::printf("\n%s: %zu patients\n", title, rows.size());
  std::printf("  both surfaces in all gates        %5.1f %%\n", share_of(rows, [](auto& o) { return o.has_surfaces; }));
  std::printf("  wrong                             %5.1f %% (%zu)\n",
              100.0 * static_cast<double>(wrong.size()) / static_cast<double>(rows.size()), wrong.size());
  std::printf("  wrong ones flagged                %5.1f %%\n", share_of(wrong, flagged));
  std::printf("  right ones flagged                %5.1f %%\n", share_of(right, flagged));
  std::printf("  ejection fraction error, points   %+5.1f +- %.1f, 95 %% within %.1f\n", mean, std::sqrt(square),
              quantile(absolute, 0.95));
  const auto line = [&](const char* name, double Outcome::*member, double limit) {
    std::printf("  %-33s median %5.2f, 95 %% %6.2f, within %.0f: %5.1f %%\n", name, quantile(all(member), 0.5),
                quantile(all(member), 0.95), limit,
                share_of(rows, [&](const Outcome& o) { return o.*member <= limit; }));
  };
  line("long axis, degrees", &Outcome::axis_deg, 5);
  line("centre, mm", &Outcome::centre_mm, 3);
  line("centre across the axis, mm", &Outcome::across_mm, 3);
  line("valve plane, mm (mean of gates)", &Outcome::base_mm, 5);
  line("division slice, slices", &Outcome::division, 1);
  line("worst border, mm", &Outcome::border_mm, 5);
  std::printf("  border within what blur explains  %5.1f %%\n",
              share_of(known, [](auto& o) { return o.border_mm <= o.allowed_mm; }));
}

int run_series(int from, int to, std::string_view preset) {
  Rows rows;
  for (int n = from; n < to; ++n) {
    const Patient patient = draw_patient(n);
    rows.push_back(examine(patient, scan(patient), preset));
    print_line(rows.back());
  }
  const auto half = [&](bool reporting) {
    return part_of(rows, [&](const Outcome& o) { return (o.patient.number >= 100) == reporting; });
  };
  print_table("Choosing half (0 to 99)", half(false));
  print_table("Reporting half (100 to 199)", half(true));
  print_table("  of it short axis", part_of(half(true), [](const Outcome& o) { return !o.patient.oblique; }));
  print_table("  of it transaxial or oblique", part_of(half(true), [](const Outcome& o) { return o.patient.oblique; }));
  print_table("  of it with a defect", part_of(half(true), [](const Outcome& o) { return o.patient.has_defect; }));
  print_table("  of it with gut", part_of(half(true), [](const Outcome& o) { return o.patient.has_gut; }));
  return 0;
}

int run_fields(int from, int to, std::string_view preset) {
  for (const std::string_view kind : field_kinds()) {
    Rows rows;
    for (int n = from; n < to; ++n) {
      const Planted p = place_in_field(kind, n);
      rows.push_back(examine(p.patient, p.phantom, preset));
      rows.back().kind = kind;
      print_line(rows.back());
    }
    print_table(std::string(kind).c_str(), rows);
  }
  return 0;
}

int run_planted(int from, int to, std::string_view only, std::string_view preset) {
  Rows rows;
  std::vector<std::string_view> kinds;
  for (const std::string_view kind : failure_kinds())
    if (only.empty() || kind == only) kinds.push_back(kind);
  for (const std::string_view kind : kinds)
    for (int n = from; n < to; ++n) {
      const Planted p = plant(kind, n);
      rows.push_back(examine(p.patient, p.phantom, preset, p.is_heart));
      rows.back().kind = kind;
      print_line(rows.back());
    }
  std::printf("\nplanted                  wrong  of them flagged   right  of them flagged\n");
  const auto line = [](const std::string& name, const Rows& part) {
    const Rows wrong = part_of(part, [](const Outcome& o) { return o.wrong(); });
    const Rows right = part_of(part, [](const Outcome& o) { return !o.wrong(); });
    const auto count = [](const Rows& r) { return part_of(r, [](const Outcome& o) { return o.flagged(); }).size(); };
    std::printf("  %-22s %5zu %12zu %12zu %12zu\n", name.c_str(), wrong.size(), count(wrong), right.size(),
                count(right));
  };
  for (const std::string_view kind : kinds)
    line(std::string(kind), part_of(rows, [&](const Outcome& o) { return o.kind == kind; }));
  line("all", rows);
  return 0;
}

int run(int count, char** arguments) {
  std::string what = "series";
  std::string_view preset = "edges";
  if (count > 1 && std::string_view(arguments[1]) == "fitted") preset = "psf_corrected", --count, ++arguments;
  if (count > 1 && std::isalpha(static_cast<unsigned char>(arguments[1][0]))) what = arguments[1], --count, ++arguments;
  const int from = count > 1 ? std::atoi(arguments[1]) : 0, to = count > 2 ? std::atoi(arguments[2]) : from + 200;
  if (what == "series") return run_series(from, to, preset);
  if (what == "fields") return run_fields(from, to, preset);
  if (what == "planted") return run_planted(from, to, count > 3 ? arguments[3] : "", preset);
  std::fprintf(stderr, "expected [fitted] series, fields or planted, and two numbers\n");
  return 1;
}

}  // namespace
}  // namespace dynasurf

int main(int count, char** arguments) { return dynasurf::run(count, arguments); }
