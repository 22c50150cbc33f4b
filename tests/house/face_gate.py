#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What others see of a case passes one gate (lib/publish/face_clearance.h). This lists every source that publishes: that makes a file,
a picture or a page of a case, or takes surfaces and volumes of a run in its hands; and fails for one that neither asks the gate nor is
known. A known one says why it need not, and names the source that asks for it, if one does.

    face_gate.py ROOT [--selftest]"""
import pathlib
import re
import sys

PUBLISHES = re.compile(r"\b(?:write_case_file|publish_case|make_case_pictures|make_side_pictures|make_findings_picture|make_removed_picture|make_case_page|"
                       r"make_page_files|draw_preview|(?:pacs|slicer|ambf)::encode_\w+)\s*\(|"
                       r"\bget(?:_if)?<\s*std::shared_ptr<const (?:grid::HuVolume|surface::TriMesh|voxel::HapticVolume)>")
ASKS = re.compile(r"\b(?:require_no_face|shows_no_skin|require_made_without_face)\s*\(")
DECLARES = re.compile(r"^\S.*\b(?:write_case_file|publish_case|make_\w+|draw_preview)\((?:const\b.*)?$")
FOLDERS = ("lib/publish", "lib/library", "lib/desk", "lib/trade", "lib/page", "lib/cluster", "lib/cases", "tools", "simulator")
# source: (why it need not ask, the source that asks for it or "")
KNOWN = {
    "lib/publish/case_content.cpp": ("makes what a run publishes", "lib/publish/run_case.cpp"),
    "lib/publish/page_files.cpp": ("makes the page of what a run publishes", "lib/publish/run_case.cpp"),
    "lib/publish/scene_limits.cpp": ("counts triangles", ""),
    "lib/trade/trade.cpp": ("measures surfaces and writes none", ""),
    "lib/page/case_page.cpp": ("makes the page of a case that it is given", "lib/publish/run_case.cpp"),
    "lib/desk/page_shelf.cpp": ("makes the page of a case that a run published", ""),
    "lib/desk/open_case.cpp": ("shows the technician the scan, by the desk's own secret", ""),
    "tools/boolean.cpp": ("cuts files that its user names", ""),
    "tools/export_dicom.cpp": ("makes objects of a case that a run published: its surfaces and its CT, and of the scan the slices' place alone", ""),
    "tools/export_scene.cpp": ("makes scenes of a case that a run published: its surfaces, its haptic volume and its CT", ""),
    "tools/page.cpp": ("makes the page of a case that a run published", ""),
    "tools/pictures.cpp": ("draws surfaces of a case that a run published", ""),
    "tools/preview.cpp": ("draws files that its user names", ""),
    "tools/voxelize.cpp": ("makes a volume of files that its user names", ""),
    "simulator/commands/drilled_case.cpp": ("takes material off a case that a run published", ""),
}


def publishes(text):
    for number, line in enumerate(text.splitlines(), 1):
        code = line.split("//")[0]
        if PUBLISHES.search(code) and not DECLARES.match(code):
            yield number, line.strip()


def main():
    root = pathlib.Path(sys.argv[1])
    if "--selftest" in sys.argv:
        for bad in ("  cases::publish_case(folder, m);", "  pacs::encode_ct(identity, ct, slices, take);", "  made = slicer::encode_scene(scene);", "  pictures = make_case_pictures(volume, shown, {});",
                    "  auto v = std::get<std::shared_ptr<const grid::HuVolume>>(at(scan).data);",
                    "  if (const auto* m = std::get_if<std::shared_ptr<const surface::TriMesh>>(&made.data))"):
            assert list(publishes(bad)), bad
        for good in ("void publish_case(const fs::path& case_folder, const CaseManifest& manifest) {", "// publish_case(x)"):
            assert not list(publishes(good)), good
        assert ASKS.search("require_no_face(config, graph, results, true);")
        return
    found, faults = set(), 0
    for folder in FOLDERS:
        for file in sorted((root / folder).rglob("*.cpp")):
            name, text = str(file.relative_to(root)), file.read_text()
            places = list(publishes(text))
            if not places or ASKS.search(text):
                continue
            found.add(name)
            if name in KNOWN:
                continue
            for number, line in places:
                print(f"{name}:{number}: {line}: ask require_no_face (lib/publish/face_clearance.h) before anybody sees it")
                faults += 1
    for name, (_, asker) in sorted(KNOWN.items()):
        if name not in found:
            print(f"tests/house/face_gate.py: {name} publishes nothing any more, or asks the gate itself")
            faults += 1
        if asker and not ASKS.search((root / asker).read_text()):
            print(f"{asker}: does not ask the face gate, and {name} relies on it")
            faults += 1
    sys.exit(1 if faults else 0)


main()
