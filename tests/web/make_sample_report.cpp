// make_sample_report FOLDER: results and reports made by hand, one folder per kind, for the tests of the page.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

#include "support/sample_result.hpp"

namespace {

using namespace dynasurf;

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw IoError("cannot write " + path.string());
}

void write_sample(const std::filesystem::path& folder, const ventricle::Result& result) {
  const report::Provenance provenance = test::sample_provenance();
  std::filesystem::create_directories(folder);
  write_text(folder / "results.json", report::results_json(result, provenance).dump(2) + "\n");
  write_text(folder / "results.csv", report::results_csv(result));
  report::write_report(result, provenance, folder / "report.html");
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("usage: make_sample_report FOLDER\n", stderr);
    return 1;
  }
  try {
    const std::filesystem::path folder = arguments[1];
    write_sample(folder / "ok", test::sample_result());
    write_sample(folder / "fitted", test::sample_fitted());
    write_sample(folder / "moving", test::sample_moving());
    write_sample(folder / "contours", test::sample_contours());
    write_sample(folder / "check", test::sample_to_check());
    write_sample(folder / "fail", test::sample_failed());
    write_sample(folder / "ungated", test::sample_ungated());
    write_sample(folder / "no_endo", test::sample_without_endo());
    write_sample(folder / "pool", test::sample_blood_pool());
    write_sample(folder / "gates16", test::sample_result({.gates = 16}));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_sample_report: %s\n", error.what());
    return 2;
  }
  return 0;
}
