// The run.json of the experiments: every option in them must be one that the library still has.
#include <filesystem>

#include <gtest/gtest.h>

#include "dynasurf/field/gvf.hpp"

#include "../../experiments/support/run_file.hpp"

namespace dynasurf::experiments {
namespace {

const std::filesystem::path folder = DYNASURF_EXPERIMENTS;

std::size_t read_rows(const RunFile& file, const std::string& table) {
  return file.at(table).at("rows").at(0).value("/options/iterations"_json_pointer, 0) > 0
             ? rows_of<field::Gvf>(file, table).size()
             : rows_of<MeshRun>(file, table).size();
}

TEST(RunFiles, OfTheExperimentsAreReadable) {
  int tables = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream stream(entry.path() / "run.json");
    if (!stream) continue;
    const RunFile file = RunFile::parse(stream);
    for (const auto& [table, content] : file.items()) {
      SCOPED_TRACE(entry.path().string() + ", " + table);
      EXPECT_EQ(read_rows(file, table), content.at("rows").size());
      ++tables;
    }
  }
  EXPECT_GE(tables, 17);
}

TEST(RunFiles, PutOptionsOfARowOverThoseOfItsTable) {
  const RunFile file = RunFile::parse(R"({"t": {"common": {"level": 2, "evolution": {"step_s": 0.5, "mass_kg": 3}},
                                               "rows": [{"name": "a"},
                                                        {"name": "b", "options": {"evolution": {"step_s": 0.1}}}]}})");
  const std::vector<Row<MeshRun>> rows = rows_of<MeshRun>(file, "t");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].options.evolution.step_s, 0.5);
  EXPECT_EQ(rows[1].options.evolution.step_s, 0.1);
  EXPECT_EQ(rows[1].options.evolution.mass_kg, 3);
  EXPECT_EQ(rows[1].options.level, 2);
}

TEST(RunFiles, AreReadStrictly) {
  const auto rows = [](const char* text) { return rows_of<MeshRun>(RunFile::parse(text), "t"); };
  EXPECT_THROW(rows(R"({"u": {"rows": []}})"), InputError);
  EXPECT_THROW(rows(R"({"t": {"rows": [{"name": "a", "optoins": {}}]}})"), InputError);
  EXPECT_THROW(rows(R"({"t": {"rows": [{"name": "a", "options": {"levle": 2}}]}})"), OptionError);
}

}  // namespace
}  // namespace dynasurf::experiments
