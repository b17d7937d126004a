#pragma once
#include <string>
#include <vector>

namespace dynasurf {

/// A number of a patient: the truth, what was read, and one standard deviation of that.
struct Measured {
  double truth = 0, value = 0, sd = 0;
};

/// One patient. No reading (value 0) where a surface was missing.
struct Row {
  std::string generator;  // plain; unlike: differs from the fitted model; untold: plain, the width is not told
  int number = 0;
  int has_defect = 0, has_gut = 0;
  Measured fwhm;                                  // mm
  double told_mm = 0;                             // the width that was told; 0: none
  Measured edv, esv, ef, wall;                    // mL, %
  double wall_variation = 0, distance_mm = 0;     // % over the beat; of both walls at both ends of the beat
  double edge_edv = 0, edge_ef = 0, seconds = 0;  // of the classic edge; of the whole study
};

std::string line_of(const Row& row);
std::vector<Row> read_rows(const std::string& file);

/// Tables of errors and of how often the 90 % intervals hold the truth, per generator and half, to the console; a
/// Bland-Altman plot of EDV, ESV and EF of the reporting half in the folder.
void print_tables(const std::vector<Row>& rows, const std::string& folder);

}  // namespace dynasurf
