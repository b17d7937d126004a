#pragma once
// Results as folders, pages, tables and DICOM: all public headers of this module.

#include "dynasurf/report/measures.hpp"
#include "dynasurf/report/normals.hpp"
#include "dynasurf/report/program_page.hpp"
#include "dynasurf/report/provenance.hpp"
#include "dynasurf/report/report.hpp"
#include "dynasurf/report/result_folders.hpp"
