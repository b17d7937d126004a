#include "dynasurf/cohort/study_list.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"

#include "support/scratch_folder.hpp"

namespace dynasurf::cohort {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class StudyTable : public testing::Test {
 protected:
  StudyList read(const std::string& name, const std::string& text) {
    std::ofstream(folder.path() / name, std::ios::binary) << text;
    return read_study_list(folder.path() / name);
  }
  std::string refusal(const std::string& name, const std::string& text) {
    try {
      read(name, text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "taken";
  }
  test::ScratchFolder folder;
};

TEST_F(StudyTable, ReadsTheSameFromTsvCsvAndJsonLines) {
  const StudyList tsv =
      read("a.tsv", "path\tid\tfwhm\tsex\toptions\na.dcm\tp1\t12.5\tF\t--preset edges\nb.dcm\tp2\t\tM\t\n");
  const StudyList csv =
      read("a.csv", "path,id,fwhm,sex,options\r\na.dcm,p1,12.5,F,--preset edges\r\n\"b.dcm\",p2,,M,\r\n");
  const StudyList json = read("a.jsonl",
                              "{\"path\": \"a.dcm\", \"id\": \"p1\", \"fwhm\": 12.5, \"sex\": \"F\", \"options\": "
                              "\"--preset edges\"}\n{\"path\": \"b.dcm\", \"id\": \"p2\", \"sex\": \"M\"}\n");
  for (const StudyList* list : {&tsv, &csv, &json}) {
    ASSERT_EQ(list->studies.size(), 2U);
    EXPECT_THAT(list->group_columns, ElementsAre("sex"));
    EXPECT_EQ(list->studies[0].path, folder.path() / "a.dcm");
    EXPECT_EQ(list->studies[0].fwhm_mm, 12.5);
    EXPECT_FALSE(list->studies[1].fwhm_mm);
    EXPECT_THAT(list->studies[0].options, ElementsAre("--preset", "edges"));
    EXPECT_THAT(list->studies[1].groups, ElementsAre("M"));
  }
}

TEST_F(StudyTable, ComesBackFromItsOwnText) {
  const StudyList list = read("a.tsv", "path\tfwhm_mm\tage\tseries\nx/y z.dcm\t11\t63\t4\nb\t\t\t\n");
  std::ofstream(folder.path() / "b.tsv") << study_list_text(list);
  const StudyList again = read_study_list(folder.path() / "b.tsv");
  ASSERT_EQ(again.studies.size(), 2U);
  EXPECT_EQ(again.studies[0].id, list.studies[0].id);
  EXPECT_EQ(again.studies[0].path, list.studies[0].path);
  EXPECT_EQ(again.studies[0].series, "4");
  EXPECT_EQ(study_list_text(again), study_list_text(list));
}

TEST_F(StudyTable, GivesIdsThatDependOnPathAndSeries) {
  const StudyList list = read("a.tsv", "path\tseries\na\t1\na\t2\nb\t1\n");
  EXPECT_NE(list.studies[0].id, list.studies[1].id);
  EXPECT_NE(list.studies[0].id, list.studies[2].id);
  EXPECT_EQ(list.studies[0].id.size(), 12U);
}

TEST_F(StudyTable, KeepsQuotesCommasAndBlanksOfCsv) {
  const StudyList list = read("a.csv", "path,site\n\"a, \"\"b\"\".dcm\",\"St. Mary, A\"\n");
  EXPECT_EQ(list.studies[0].path.filename(), "a, \"b\".dcm");
  EXPECT_THAT(list.studies[0].groups, ElementsAre("St. Mary, A"));
}

TEST_F(StudyTable, IsRefusedInOneLineThatNamesThePlace) {
  const auto expect = [&](const char* name, const char* text, const char* says) {
    const std::string said = refusal(name, text);
    EXPECT_THAT(said, HasSubstr(says)) << text;
    EXPECT_EQ(said.find('\n'), std::string::npos);
  };
  expect("a.txt", "path\na\n", "ends in .tsv, .csv or .jsonl");
  expect("a.tsv", "", "is empty");
  expect("a.tsv", "id\np1\n", "line 1: has no column path");
  expect("a.tsv", "path\tid\na\n", "line 2: 1 cells; expected 2");
  expect("a.tsv", "path\tpath\na\tb\n", "column path stands twice");
  expect("a.tsv", "path\tid\na\tx\nb\tx\n", "line 3: id x stands in line 2 too");
  expect("a.tsv", "path\tid\na\t../x\n", "line 2: id is ../x");
  expect("a.tsv", "path\tid\na\t.x\n", "no dot first");
  expect("a.tsv", "path\tfwhm\na\t12 mm\n", "fwhm_mm is 12 mm; expected millimetres");
  expect("a.tsv", "path\tfwhm\na\tnan\n", "expected millimetres");
  expect("a.tsv", "path\tfwhm\tfwhm_mm\na\t1\t2\n", "expected one");
  expect("a.tsv", "path\tsex of the patient\na\tF\n", "expected a name of letters");
  expect("a.tsv", "path\n\ta\n", "line 2: 2 cells");
  expect("a.tsv", "path\na\x01\n", "control character");
  expect("a.csv", "path\n\"a\n", "a quote is not closed");
  expect("a.csv", "path\n\"a\"b\n", "expected a comma");
  expect("a.jsonl", "[1]\n", "line 1: is no object");
  expect("a.jsonl", "{\"path\": [1]}\n", "is a list or an object");
  expect("a.jsonl", "{\"path\": \"a\",}\n", "line 1");
  expect("a.jsonl", "{\"path\": \"a\", \"\": \"b\"}\n", "expected a name of letters");
}

}  // namespace
}  // namespace dynasurf::cohort
