#pragma once
// Results as folders, pages, tables and DICOM: all public headers of this module.

#include "dynasurf/report/cloud_folder.hpp"
#include "dynasurf/report/cloud_report.hpp"
#include "dynasurf/report/measures.hpp"
#include "dynasurf/report/normals.hpp"
#include "dynasurf/report/provenance.hpp"
#include "dynasurf/report/report.hpp"
#include "dynasurf/report/study_folder.hpp"
