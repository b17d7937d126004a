#pragma once
// Results as folders, pages, tables and DICOM: all public headers of this module.

#include "dynasurf/report/cloud_folder.hpp"
#include "dynasurf/report/cloud_report.hpp"
#include "dynasurf/report/comparison_page.hpp"
#include "dynasurf/report/dicom_folder.hpp"
#include "dynasurf/report/label_volumes.hpp"
#include "dynasurf/report/lod_page.hpp"
#include "dynasurf/report/measures.hpp"
#include "dynasurf/report/motion_results.hpp"
#include "dynasurf/report/normals.hpp"
#include "dynasurf/report/provenance.hpp"
#include "dynasurf/report/report.hpp"
#include "dynasurf/report/run_record.hpp"
#include "dynasurf/report/sheets.hpp"
#include "dynasurf/report/stages.hpp"
#include "dynasurf/report/study_folder.hpp"
