"""The DICOM results before those who read them: dciodvfy, pydicom, and an archive (Orthanc) on this machine alone."""

import contextlib
import json
import pathlib
import re
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.request

try:
    import numpy
    import pydicom
except ImportError:
    print("skipped: pydicom (package python3-pydicom) and NumPy are not installed")
    sys.exit(77)

PROGRAM = sys.argv.pop(1)
# Voxels of an odd number in a slice: the bits of a mask do not end with a byte.
SMALL = ["--set", "gates=4", "--set", "lattice.nx=41", "--set", "lattice.ny=39", "--set", "lattice.dx_mm=4",
         "--set", "lattice.dy_mm=4", "--set", "fwhm_mm=10"]
# Our own coding scheme, whose name begins with 99 as the standard asks, is in no list of dciodvfy.
EXPECTED_WARNING = "Unrecognized defined term <99DYNASURF>"


def run(*words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stdout + done.stderr
    return done


def study_of_a_person(folder):
    """A study as a hospital would store it: with a name that is not plain ASCII."""
    run(PROGRAM, "phantom", "patient", "--seed", 7, "--out", folder / "patient", *SMALL)
    path = folder / "study.dcm"
    data = pydicom.dcmread(folder / "patient" / "study.dcm")
    data.SpecificCharacterSet = "ISO_IR 100"
    data.PatientName = "Müller^Ann"
    data.PatientID = "4711"
    data.PatientBirthDate = "19500102"
    data.PatientSex = "F"
    data.AccessionNumber = "A17"
    data.StudyDate = "20240506"
    data.StudyTime = "070809"
    data.save_as(path)
    return path


def corners_of(stl):
    count, = struct.unpack_from("<I", stl, 80)
    return numpy.frombuffer(stl, numpy.dtype([("n", "<f4", 3), ("p", "<f4", (3, 3)), ("a", "<u2")]), count, 84)["p"]


def volume_ml(stl):
    """Signed volume of a binary STL in mm."""
    a, b, c = (corners_of(stl)[:, n].astype(float) for n in range(3))
    return numpy.einsum("ij,ij->i", a, numpy.cross(b, c)).sum() / 6000


def centre_of(stl):
    """Of the volume that a binary STL encloses."""
    a, b, c = (corners_of(stl)[:, n].astype(float) for n in range(3))
    volumes = numpy.einsum("ij,ij->i", a, numpy.cross(b, c))
    return ((a + b + c) * volumes[:, None]).sum(axis=0) / (4 * volumes.sum())


def centre_of_segment(data, number):
    """In mm, of the voxels of a segment."""
    shared = data.SharedFunctionalGroupsSequence[0]
    spacing = [float(v) for v in shared.PixelMeasuresSequence[0].PixelSpacing]
    along = numpy.array([float(v) for v in shared.PlaneOrientationSequence[0].ImageOrientationPatient]).reshape(2, 3)
    voxels = []
    for frame, pixels in zip(data.PerFrameFunctionalGroupsSequence, data.pixel_array.reshape(-1, data.Rows, data.Columns)):
        if frame.SegmentIdentificationSequence[0].ReferencedSegmentNumber == number:
            first = numpy.array([float(v) for v in frame.PlanePositionSequence[0].ImagePositionPatient])
            row, column = numpy.nonzero(pixels)
            voxels.append(first + numpy.outer(column * spacing[1], along[0]) + numpy.outer(row * spacing[0], along[1]))
    return numpy.concatenate(voxels).mean(axis=0)


def items(item):
    """An SR content item and all below it."""
    yield item
    for child in item.get("ContentSequence", []):
        yield from items(child)


def name_of(item):
    return item.ConceptNameCodeSequence[0].CodeMeaning if "ConceptNameCodeSequence" in item else ""


class DicomResults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="dynasurf-dicom-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.study = study_of_a_person(cls.folder)
        words = ["--pdf"] if shutil.which("chromium") else []
        run(PROGRAM, "ventricle", cls.study, "--out", cls.folder / "result", "--dicom", "--quiet", *words)
        cls.results = json.loads((cls.folder / "result" / "results.json").read_text())
        cls.files = sorted((cls.folder / "result" / "dicom").glob("*.dcm"))
        cls.objects = {path.stem: pydicom.dcmread(path) for path in cls.files}

    def test_every_object_is_there(self):
        expected = {"measurements"} | {f"{kind}_g0{g}" for kind in ("endo", "epi", "segmentation") for g in range(1, 5)}
        if shutil.which("chromium"):
            expected.add("report")
        self.assertEqual(set(self.objects), expected)

    def test_dciodvfy_has_nothing_to_say(self):
        if not shutil.which("dciodvfy"):
            self.skipTest("dciodvfy (package dicom3tools) is not installed")
        for path in self.files:
            said = subprocess.run(["dciodvfy", path], capture_output=True, text=True, timeout=60)
            lines = [line for line in (said.stdout + said.stderr).splitlines()
                     if line.startswith(("Error", "Warning")) and EXPECTED_WARNING not in line]
            self.assertEqual(lines, [], path.name)

    def test_patient_and_study_are_those_of_the_input(self):
        source = pydicom.dcmread(self.study)
        for name, data in self.objects.items():
            for key in ("PatientName", "PatientID", "PatientBirthDate", "PatientSex", "AccessionNumber",
                        "StudyInstanceUID", "StudyDate", "StudyTime", "SpecificCharacterSet"):
                self.assertEqual(data[key].value, source[key].value, f"{name} {key}")
            self.assertNotEqual(data.SeriesInstanceUID, source.SeriesInstanceUID, name)
        uids = [data.SOPInstanceUID for data in self.objects.values()]
        self.assertEqual(len(set(uids)), len(uids))
        series = {data.Modality: data.SeriesInstanceUID for data in self.objects.values()}
        self.assertEqual(len(set(series.values())), len(series))

    def test_nothing_else_names_the_person(self):
        for path in (self.folder / "result").rglob("*"):
            if path.is_file() and path.parent.name != "dicom":
                self.assertNotIn("ller^Ann".encode(), path.read_bytes(), path.name)

    def test_measurements_are_those_of_results_json(self):
        report = self.objects["measurements"]
        self.assertEqual(report.ContentTemplateSequence[0].TemplateIdentifier, "1500")
        groups = [item for item in items(report) if name_of(item) == "Measurement Group"]

        def numbers(tracking):
            group, = [g for g in groups if any(name_of(i) == "Tracking Identifier" and i.TextValue == tracking
                                               for i in g.ContentSequence)]
            return {name_of(i): float(i.MeasuredValueSequence[0].NumericValue)
                    for i in group.ContentSequence if i.ValueType == "NUM"}

        for tracking, key in (("PSF-corrected reading", "psf_corrected"), ("Edge reading", "edge")):
            reading = self.results["readings"][key]
            read = numbers(tracking)
            self.assertAlmostEqual(read["Left Ventricular Ejection Fraction"], reading["ef_percent"], 3)
            self.assertAlmostEqual(read["Left Ventricular ED Volume"], reading["edv_ml"], 3)
            self.assertAlmostEqual(read["Left Ventricular ES Volume"], reading["esv_ml"], 3)
            self.assertAlmostEqual(read["Stroke Volume"], reading["sv_ml"], 3)
        for gate in self.results["gates"]:
            self.assertAlmostEqual(numbers(f"Cavity, gate {gate['gate']}")["Volume"], gate["endo_ml"], 3)
        segment = self.results["measures"]["segments"][6]
        self.assertAlmostEqual(numbers("Segment 7")["Myocardial perfusion"], segment["perfusion_percent"], 3)
        self.assertIn("Research use only. Not for diagnosis.",
                      [i.TextValue for i in items(report) if i.get("ValueType") == "TEXT"])

    def test_measurements_refer_to_objects_that_are_there(self):
        known = {data.SOPInstanceUID for data in self.objects.values()} | {pydicom.dcmread(self.study).SOPInstanceUID}
        references = [i.ReferencedSOPSequence[0] for i in items(self.objects["measurements"])
                      if i.get("ValueType") == "IMAGE"]
        self.assertEqual(len(references), 2 * 4)
        for reference in references:
            self.assertIn(reference.ReferencedSOPInstanceUID, known)
            self.assertIn(reference.ReferencedSegmentNumber, (1, 2))

    def test_segmentations_hold_the_volumes_where_the_study_lies(self):
        source = pydicom.dcmread(self.study)
        for g in range(1, 5):
            data = self.objects[f"segmentation_g0{g}"]
            measures = data.SharedFunctionalGroupsSequence[0].PixelMeasuresSequence[0]
            voxel_ml = float(numpy.prod(measures.PixelSpacing)) * measures.SpacingBetweenSlices / 1000
            frames = [f.SegmentIdentificationSequence[0].ReferencedSegmentNumber
                      for f in data.PerFrameFunctionalGroupsSequence]
            pixels = data.pixel_array.reshape(-1, data.Rows, data.Columns)
            gate = self.results["gates"][g - 1]
            for number, truth in ((1, gate["endo_ml"]), (2, gate["epi_ml"] - gate["endo_ml"])):
                held = sum(int(pixels[n].sum()) for n, of in enumerate(frames) if of == number) * voxel_ml
                # Whole voxels of 0.09 mL at a border of some 100 cm2: a few per cent.
                self.assertAlmostEqual(held / truth, 1, delta=0.06, msg=f"gate {g}, segment {number}")
            slices = {}
            for n, frame in enumerate(data.PerFrameFunctionalGroupsSequence):
                slices.setdefault(tuple(frame.PlanePositionSequence[0].ImagePositionPatient), []).append(pixels[n])
            for parts in slices.values():
                self.assertLessEqual(int(sum(p.astype(int) for p in parts).max()), 1, "cavity and wall share a voxel")
            surface = self.objects[f"endo_g0{g}"]
            apart = centre_of_segment(data, 1) - centre_of(surface.EncapsulatedDocument[:surface.EncapsulatedDocumentLength])
            self.assertLess(numpy.linalg.norm(apart), 1, f"gate {g}: the mask lies beside its surface")
            self.assertEqual(data.FrameOfReferenceUID, source.FrameOfReferenceUID)
            reference = data.ReferencedSeriesSequence[0].ReferencedInstanceSequence[0]
            self.assertEqual(reference.ReferencedSOPInstanceUID, source.SOPInstanceUID)

    def test_surfaces_are_closed_and_of_the_right_volume(self):
        for g in range(1, 5):
            gate = self.results["gates"][g - 1]
            for wall in ("endo", "epi"):
                data = self.objects[f"{wall}_g0{g}"]
                stl = data.EncapsulatedDocument[:data.EncapsulatedDocumentLength]
                # Single precision at 100 mm from the origin.
                self.assertAlmostEqual(volume_ml(stl) / gate[f"{wall}_ml"], 1, delta=1e-3)
                self.assertEqual(data.MeasurementUnitsCodeSequence[0].CodeValue, "mm")

    def test_the_report_is_the_two_printed_pages(self):
        if "report" not in self.objects:
            self.skipTest("chromium is not installed")
        data = self.objects["report"]
        pdf = data.EncapsulatedDocument[:data.EncapsulatedDocumentLength]
        self.assertEqual(pdf, (self.folder / "result" / "report.pdf").read_bytes())
        self.assertEqual(pdf[:5], b"%PDF-")
        self.assertEqual(len(re.findall(rb"/Type /Page\b", pdf)), 2)

    def test_equal_runs_give_equal_objects(self):
        for name in ("first", "second"):
            run(PROGRAM, "ventricle", self.study, "--out", self.folder / name, "--dicom", "--no-timings", "--quiet",
                "--preset", "edges")
        for path in (self.folder / "first" / "dicom").iterdir():
            self.assertEqual(path.read_bytes(), (self.folder / "second" / "dicom" / path.name).read_bytes(), path.name)

    def test_a_repeated_run_gives_the_same_bytes(self):
        run(PROGRAM, "rerun", self.folder / "result")

    def test_a_study_without_a_patient_gets_an_id_of_its_own(self):
        out = self.folder / "nameless"
        run(PROGRAM, "ventricle", self.folder / "patient" / "study.nii.gz", "--out", out, "--dicom", "--quiet", "--preset",
            "edges")
        data = pydicom.dcmread(out / "dicom" / "measurements.dcm")
        self.assertRegex(data.PatientID, "^DYNASURF-[0-9]{12}$")
        self.assertEqual(str(data.PatientName), "")
        segmentation = pydicom.dcmread(out / "dicom" / "segmentation_g01.dcm")
        self.assertEqual(segmentation.StudyInstanceUID, data.StudyInstanceUID)
        self.assertTrue(segmentation.FrameOfReferenceUID.startswith("2.25."))

    def test_an_archive_stores_them_in_the_patients_study(self):
        program = shutil.which("Orthanc")
        if not program:
            self.skipTest("Orthanc (package orthanc) is not installed")
        with archive(program, self.folder / "archive") as ask:
            for path in [self.study, *self.files]:
                self.assertEqual(ask("/instances", path.read_bytes())["Status"], "Success", path.name)
            statistics = ask("/statistics")
            self.assertEqual(statistics["CountPatients"], 1)
            self.assertEqual(statistics["CountStudies"], 1)
            self.assertEqual(statistics["CountInstances"], 1 + len(self.files))
            study = ask("/studies/" + ask("/studies")[0])
            self.assertEqual(study["PatientMainDicomTags"]["PatientName"], "Müller^Ann")
            self.assertEqual(study["MainDicomTags"]["AccessionNumber"], "A17")


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


@contextlib.contextmanager
def archive(program, folder):
    """An Orthanc that listens on the loopback interface alone, and a function that asks it."""
    folder.mkdir()
    port = free_port()
    settings = {"Name": "test", "StorageDirectory": str(folder / "db"), "IndexDirectory": str(folder / "db"), "Plugins": [],
                "HttpServerEnabled": True, "HttpPort": port, "HttpBindAddresses": ["127.0.0.1"], "HttpDescribeErrors": True,
                "RemoteAccessAllowed": False, "AuthenticationEnabled": False, "DicomServerEnabled": False}
    (folder / "settings.json").write_text(json.dumps(settings))
    with (folder / "log").open("w") as log:
        server = subprocess.Popen([program, folder / "settings.json"], stdout=log, stderr=log)

    def ask(path, body=None):
        with urllib.request.urlopen(f"http://127.0.0.1:{port}{path}", data=body, timeout=30) as answer:
            return json.load(answer)

    try:
        for _ in range(300):
            with contextlib.suppress(OSError):
                ask("/system")
                break
            if server.poll() is not None:
                raise AssertionError("Orthanc ended: " + (folder / "log").read_text())
            time.sleep(0.1)
        yield ask
    finally:
        server.terminate()
        server.wait(30)


if __name__ == "__main__":
    unittest.main(verbosity=2)
