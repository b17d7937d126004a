#!/usr/bin/env python3
"""Writes a bill of materials of this project as SPDX 2.3.

    sbom.py --program PROGRAM [--packages NAME,...] [--created SECONDS] OUT.json

It lists the project, the Debian packages that PROGRAM loads (with their versions here), those it is built from
(--packages, as ./dev names them) and every package of web/package-lock.json. tools/check_sbom.py checks it.
"""

import argparse
import base64
import datetime
import hashlib
import json
import os
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Debian's words for licences, where SPDX has others.
SPDX_NAMES = {
    "apache-2": "Apache-2.0", "apache-2.0": "Apache-2.0", "boost-1.0": "BSL-1.0", "bsl-1.0": "BSL-1.0",
    "bsd-2-clause": "BSD-2-Clause", "bsd-3-clause": "BSD-3-Clause", "bsd": "BSD-3-Clause", "bsd3": "BSD-3-Clause",
    "cc0-1.0": "CC0-1.0", "expat": "MIT", "mit": "MIT", "isc": "ISC", "gpl-2": "GPL-2.0-only", "gpl-2.0": "GPL-2.0-only",
    "gpl-2+": "GPL-2.0-or-later", "gpl-2.0+": "GPL-2.0-or-later", "gpl-3": "GPL-3.0-only", "gpl-3+": "GPL-3.0-or-later",
    "gpl-3.0+": "GPL-3.0-or-later", "lgpl-2": "LGPL-2.0-only", "lgpl-2+": "LGPL-2.0-or-later",
    "lgpl-2.0+": "LGPL-2.0-or-later", "lgpl-2.1": "LGPL-2.1-only", "lgpl-2.1+": "LGPL-2.1-or-later",
    "lgpl-3": "LGPL-3.0-only", "lgpl-3+": "LGPL-3.0-or-later", "mpl-2.0": "MPL-2.0", "mpl-2": "MPL-2.0",
    "mpl-1.1": "MPL-1.1", "zlib": "Zlib", "artistic-2.0": "Artistic-2.0", "artistic-2": "Artistic-2.0",
    "libpng": "Libpng", "openssl": "OpenSSL", "psf-2": "PSF-2.0", "unlicense": "Unlicense", "ijg": "IJG",
}
WITHOUT_WORDS = {"licenseConcluded": "NOASSERTION", "copyrightText": "NOASSERTION", "filesAnalyzed": False}


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def installed(packages):
    """(name, version, architecture, source) of Debian packages that are installed here, in order of their names."""
    form = "${Package}\\t${Version}\\t${Architecture}\\t${source:Package}\\n"
    # dpkg-query fails when it does not know one of them, and still tells of the others.
    told = subprocess.run(["dpkg-query", "-W", f"-f={form}", *sorted(packages)], capture_output=True, text=True).stdout
    rows = {tuple(row.split("\t")) for row in told.splitlines()}
    return sorted(row for row in rows if row[1])


def loaded_by(program):
    """Names of the Debian packages whose shared libraries the program loads, directly or through another."""
    paths = set()
    for library in re.findall(r"(?:=> |^\s*)(/\S+) \(0x", output_of("ldd", str(program)), re.MULTILINE):
        # dpkg may know a library by its place before /lib became /usr/lib.
        paths |= {library, str(pathlib.Path(library).resolve()), library.removeprefix("/usr"), "/usr" + library}
    owners = subprocess.run(["dpkg-query", "-S", *sorted(paths)], capture_output=True, text=True).stdout
    return {line.split(":")[0] for line in owners.splitlines() if not line.startswith("diversion ")}


def licence_of(package):
    """An SPDX expression from a machine-readable copyright file, or NOASSERTION, and Debian's own words."""
    path = pathlib.Path("/usr/share/doc", package, "copyright")
    text = path.read_text(errors="replace") if path.exists() else ""
    if not re.match(r"Format: *\S*(copyright-format|dep5)", text, re.IGNORECASE):
        return "NOASSERTION", ""
    told = sorted({words.strip() for words in re.findall(r"^License:(.*)$", text, re.MULTILINE) if words.strip()})
    parts = set()
    for words in told:
        # Debian joins by commas too: `GPL-2+ or MIT, and BSD-3-clause`.
        terms = re.split(r"(?:,\s*)?\b(and|or)\b", words)
        names = [SPDX_NAMES.get(term.strip().lower()) for term in terms[::2]]
        if None in names or len(set(terms[1::2])) > 1:
            return "NOASSERTION", "; ".join(told)
        joined = names[0]
        for word, name in zip(terms[1::2], names[1:]):
            joined += f" {word.upper()} {name}"
        parts.add(f"({joined})" if len(names) > 1 else joined)
    return " AND ".join(sorted(parts)) or "NOASSERTION", "; ".join(told)


def debian_package(name, version, architecture, source):
    licence, words = licence_of(name)
    package = {"SPDXID": "SPDXRef-deb-" + re.sub(r"[^A-Za-z0-9.-]", "-", name.replace("+", "-plus")), "name": name,
               "versionInfo": version, "downloadLocation": "NOASSERTION", "licenseDeclared": licence,
               "sourceInfo": f"built from the Debian source package {source}", **WITHOUT_WORDS,
               "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                                 "referenceLocator": f"pkg:deb/debian/{name.replace('+', '%2B')}@"
                                                     f"{version.replace('+', '%2B').replace(':', '%3A')}"
                                                     f"?arch={architecture}&distro=debian-12"}]}
    if words and licence == "NOASSERTION":
        package["licenseComments"] = f"Debian's copyright file names: {words}"
    return package


def npm_package(path, entry):
    name = path.rpartition("node_modules/")[2]
    algorithm, _, digest = entry["integrity"].partition("-")
    package = {"SPDXID": "SPDXRef-npm-" + re.sub(r"[^A-Za-z0-9.-]", "-", path.removeprefix("node_modules/")), "name": name,
               "versionInfo": entry["version"], "downloadLocation": entry.get("resolved", "NOASSERTION"),
               "licenseDeclared": entry.get("license", "NOASSERTION"), **WITHOUT_WORDS,
               "checksums": [{"algorithm": algorithm.upper(), "checksumValue": base64.b64decode(digest).hex()}],
               "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                                 "referenceLocator": f"pkg:npm/{name.replace('@', '%40')}@{entry['version']}"}]}
    return package


def npm_entries():
    """Path -> entry of the lock file, without the project itself."""
    lock = json.loads((ROOT / "web/package-lock.json").read_text())
    return {path: entry for path, entry in sorted(lock["packages"].items()) if path}


def npm_role(path, entry):
    """What a package of npm is to the program: part of its pages, a tool of the build or of the tests."""
    if path == "node_modules/three":
        return "CONTAINS"
    return "DEV_DEPENDENCY_OF" if entry.get("dev") else "BUILD_DEPENDENCY_OF"


def project_version():
    return re.search(r"project\(dynasurf VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]


def document(program, build_packages, seconds):
    project = {"SPDXID": "SPDXRef-dynasurf", "name": "dynasurf", "versionInfo": project_version(),
               "downloadLocation": "NOASSERTION", "licenseDeclared": "Apache-2.0", **WITHOUT_WORDS,
               "primaryPackagePurpose": "APPLICATION", "supplier": "Organization: The Dynasurf authors"}
    packages, relations = [project], [("SPDXRef-DOCUMENT", "DESCRIBES", project["SPDXID"])]
    loaded = loaded_by(program)
    for row in installed(loaded | set(build_packages)):
        package = debian_package(*row)
        packages.append(package)
        if row[0] in loaded:
            relations.append((package["SPDXID"], "RUNTIME_DEPENDENCY_OF", project["SPDXID"]))
        if row[0] in build_packages:
            relations.append((package["SPDXID"], "BUILD_DEPENDENCY_OF", project["SPDXID"]))
    for path, entry in npm_entries().items():
        package = npm_package(path, entry)
        packages.append(package)
        role = npm_role(path, entry)
        ends = (package["SPDXID"], project["SPDXID"])
        first, second = reversed(ends) if role == "CONTAINS" else ends
        relations.append((first, role, second))
    digest = hashlib.sha256(json.dumps([packages, relations], sort_keys=True).encode()).hexdigest()
    created = datetime.datetime.fromtimestamp(seconds, datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
    return {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT",
            "name": f"dynasurf-{project['versionInfo']}",
            "documentNamespace": f"https://spdx.org/spdxdocs/dynasurf-{project['versionInfo']}-{digest[:32]}",
            "creationInfo": {"created": created, "creators": ["Tool: dynasurf-sbom"]},
            "packages": packages,
            "relationships": [{"spdxElementId": first, "relationshipType": kind, "relatedSpdxElement": second}
                              for first, kind, second in relations]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, required=True)
    parser.add_argument("--packages", default="", help="Debian packages of the build, with commas between them")
    parser.add_argument("--created", type=int, default=int(os.environ.get("SOURCE_DATE_EPOCH", 0)))
    parser.add_argument("out", type=pathlib.Path)
    arguments = parser.parse_args()
    build_packages = {name for name in arguments.packages.split(",") if name}
    text = json.dumps(document(arguments.program, build_packages, arguments.created), indent=2, ensure_ascii=False)
    arguments.out.write_text(text + "\n")


if __name__ == "__main__":
    main()
