#!/usr/bin/env python3
"""Checks a bill of materials (SPDX 2.3) against what dpkg and web/package-lock.json say, and fails on any difference.

    check_sbom.py [--program PROGRAM] [--packages NAME,...] FILE

With --program, all Debian packages whose libraries it loads have to be listed, with --packages those too, and nothing
else.
"""

import argparse
import base64
import collections
import json
import pathlib
import re
import sys

import sbom

FIELDS = ("spdxVersion", "dataLicense", "SPDXID", "name", "documentNamespace", "creationInfo", "packages",
          "relationships")
PACKAGE_FIELDS = ("SPDXID", "name", "versionInfo", "downloadLocation", "licenseDeclared", "licenseConcluded",
                  "copyrightText", "filesAnalyzed")


def wrong_form(document):
    """What SPDX 2.3 asks of every document."""
    missing = [field for field in FIELDS if field not in document]
    if missing:
        yield f"fields are missing: {', '.join(missing)}"
        return
    if document["spdxVersion"] != "SPDX-2.3" or document["dataLicense"] != "CC0-1.0":
        yield "this is no SPDX 2.3 under CC0-1.0"
    if not re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", document["creationInfo"].get("created", "")):
        yield "creationInfo.created is no time"
    ids = collections.Counter(package.get("SPDXID") for package in document["packages"])
    yield from (f"{name}: named {count} times" for name, count in ids.items() if count > 1)
    for package in document["packages"]:
        lacks = [field for field in PACKAGE_FIELDS if field not in package]
        if lacks:
            yield f"{package.get('name')}: fields are missing: {', '.join(lacks)}"
        if not re.fullmatch(r"SPDXRef-[A-Za-z0-9.-]+", package.get("SPDXID", "")):
            yield f"{package.get('SPDXID')}: no name of an element"
    related = {ends[key] for ends in document["relationships"] for key in ("spdxElementId", "relatedSpdxElement")}
    yield from (f"{name}: a relationship leads nowhere" for name in sorted(related - set(ids) - {"SPDXRef-DOCUMENT"}))
    yield from (f"{name}: listed without a relationship" for name in sorted(set(ids) - related))


def of_kind(document, kind):
    """Packages by purl type: deb or npm."""
    return [package for package in document["packages"]
            if any(ref["referenceLocator"].startswith(f"pkg:{kind}/") for ref in package.get("externalRefs", []))]


def wrong_debian(document, program, build_packages):
    listed = {package["name"]: package for package in of_kind(document, "deb")}
    here = {row[0]: row for row in sbom.installed(listed)}
    for name, package in listed.items():
        if name not in here:
            yield f"{name}: not installed here"
            continue
        _, version, architecture, source = here[name]
        if package["versionInfo"] != version:
            yield f"{name}: version {package['versionInfo']}, but dpkg says {version}"
        if package != sbom.debian_package(name, version, architecture, source):
            yield f"{name}: licence, source or purl differ from those of the installed package"
    wanted = {}
    if program:
        wanted["RUNTIME_DEPENDENCY_OF"] = sbom.loaded_by(program)
    if build_packages:
        wanted["BUILD_DEPENDENCY_OF"] = build_packages
    ids = {package["SPDXID"]: name for name, package in listed.items()}
    for kind, names in wanted.items():
        told = {ids.get(ends["spdxElementId"]) for ends in document["relationships"] if ends["relationshipType"] == kind}
        told.discard(None)
        yield from (f"{name}: missing as {kind}" for name in sorted(names - told))
        yield from (f"{name}: listed as {kind}, which it is not" for name in sorted(told - names))


def wrong_npm(document):
    listed = {package["SPDXID"]: package for package in of_kind(document, "npm")}
    for path, entry in sbom.npm_entries().items():
        wanted = sbom.npm_package(path, entry)
        package = listed.pop(wanted["SPDXID"], None)
        if package is None:
            yield f"{path}: missing, but in package-lock.json"
        elif package["versionInfo"] != entry["version"]:
            yield f"{path}: version {package['versionInfo']}, but package-lock.json says {entry['version']}"
        elif integrity_of(package) != entry["integrity"]:
            yield f"{path}: checksum {integrity_of(package)}, but package-lock.json says {entry['integrity']}"
        elif package != wanted:
            yield f"{path}: licence, source or purl differ from those in package-lock.json"
    yield from (f"{package['name']}: listed, but not in package-lock.json" for package in listed.values())


def integrity_of(package):
    checksum, = package["checksums"]
    digest = base64.b64encode(bytes.fromhex(checksum["checksumValue"])).decode()
    return f"{checksum['algorithm'].lower()}-{digest}"


def wrong_project(document):
    versions = [package["versionInfo"] for package in document["packages"] if package["SPDXID"] == "SPDXRef-dynasurf"]
    if versions != [sbom.project_version()]:
        yield f"dynasurf: listed with the versions {versions}, but CMakeLists.txt says {sbom.project_version()}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path)
    parser.add_argument("--packages", default="")
    parser.add_argument("file", type=pathlib.Path)
    arguments = parser.parse_args()
    document = json.loads(arguments.file.read_text())
    failures = list(wrong_form(document))
    if not failures:
        build_packages = {name for name in arguments.packages.split(",") if name}
        failures += [*wrong_project(document), *wrong_debian(document, arguments.program, build_packages),
                     *wrong_npm(document)]
    packages = len(document.get("packages", []))
    print("\n".join(failures) if failures else f"{arguments.file}: {packages} packages are as dpkg and npm know them")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
