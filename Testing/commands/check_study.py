# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Checks the exports of a study without any code of ours: BIDS-Prov, PROV-JSON (also as python's prov reads it), and
the sidecars of a BIDS derivative.  Usage: check_study.py OUT PROV_JSON"""

import hashlib
import json
import pathlib
import re
import sys

from prov.model import (ProvActivity, ProvAgent, ProvAssociation, ProvDocument, ProvEntity,
                        ProvGeneration, ProvUsage)

out = pathlib.Path(sys.argv[1])
faults = []


def check(holds, message):
    if not holds:
        faults.append(message)


def load(path):
    return json.loads(path.read_text(encoding="utf-8"))


def sha256(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


# ---- BIDS-Prov (BEP028) ----
parts = {}
for part, key in (("act", "Activities"), ("ent", "Entities"), ("env", "Environments"),
                  ("soft", "Software")):
    listed = load(out / "prov" / f"prov-explica_{part}.json")[key]
    parts[part] = {entry["Id"]: entry for entry in listed}
    check(len(parts[part]) == len(listed), f"prov: an Id stands twice in {part}")
    check(listed, f"prov: {part} is empty")
everything = {**parts["act"], **parts["ent"], **parts["env"], **parts["soft"]}
for identifier, activity in parts["act"].items():
    check(activity["AssociatedWith"] in parts["soft"], f"prov: software of {identifier}")
    for used in activity["Used"]:
        check(used in everything, f"prov: {identifier} used {used}")
for identifier, entity in parts["ent"].items():
    check(len(entity["Digest"]["sha256"]) == 64, f"prov: digest of {identifier}")
    if "GeneratedBy" in entity:
        check(entity["GeneratedBy"] in parts["act"], f"prov: maker of {identifier}")
    if identifier.startswith("bids::") and "#" not in identifier:
        check((out / identifier[6:]).is_file(), f"prov: {identifier} is not there")

# ---- derivative: description and sidecars ----
description = load(out / "dataset_description.json")
for key in ("Name", "BIDSVersion", "GeneratedBy", "SourceDatasets", "DatasetLinks"):
    check(key in description, f"dataset_description.json: {key}")
check(description["DatasetType"] == "derivative", "dataset_description.json: type")
check(all("Name" in tool and "Version" in tool for tool in description["GeneratedBy"]), "tools")
links = {name: (out / target).resolve() for name, target in description["DatasetLinks"].items()}
with (out / "descriptions.tsv").open(encoding="utf-8") as table:
    described = {line.split("\t")[0] for line in table}


def resolves(uri):
    match = re.fullmatch(r"bids:([^:]*):(.+)", uri)
    if not match:
        return uri.startswith("file://")
    base = out if match[1] == "" else links.get(match[1])
    return base is not None and (base / match[2]).is_file()


sidecars = 0
for path in sorted(out.glob("sub-*/**/anat/*")):
    if path.suffix == ".json":
        check(any(other != path and other.name.startswith(path.stem + ".")
                  for other in path.parent.iterdir()), f"{path.name}: belongs to no file")
        continue
    sidecar = load(path.parent / (path.name.split(".")[0] + ".json"))
    sidecars += 1
    check(re.fullmatch(r"sub-[A-Za-z0-9]+(_ses-[A-Za-z0-9]+)?(_hemi-[LR])?(_(space|den|label|desc|from|to|mode)"
                       r"-[A-Za-z0-9]+)*_[A-Za-z]+(\.[a-z0-9]+)+", path.name),
          f"{path.name}: is no BIDS name")
    desc = re.search(r"_desc-([A-Za-z0-9]+)", path.name)
    check(not desc or desc[1] in described, f"{path.name}: desc is not in descriptions.tsv")
    check(sidecar["Sources"], f"{path.name}: no Sources")
    for source in sidecar["Sources"]:
        check(resolves(source), f"{path.name}: source {source} is not there")
    space = sidecar["SpatialReference"]
    check(space == "orig" or resolves(space), f"{path.name}: SpatialReference {space}")
    for key in ("EulerNumber", "NumberOfDefects"):
        check(key in sidecar or "_hemi-" not in path.name, f"{path.name}: {key}")
    if path.name.endswith((".surf.gii", "_thickness.shape.gii", "_thickness.nii.gz")):
        check(sidecar["Units"] == "mm", f"{path.name}: Units")
    check(sidecar["Digest"]["sha256"] == sha256(path), f"{path.name}: digest")
    check(sidecar["GeneratedBy"] in parts["act"], f"{path.name}: {sidecar['GeneratedBy']}")
check(sidecars >= 8, "hardly a sidecar")

# ---- PROV-JSON: https://www.w3.org/submissions/prov-json ----
prov = load(pathlib.Path(sys.argv[2]))
prefixes = set(prov["prefix"]) | {"_"}
for kind in ("entity", "activity", "agent"):
    for name in prov[kind]:
        check(name.split(":")[0] in prefixes, f"PROV-JSON: prefix of {name}")
for relation, ends in (("used", ("activity", "entity")), ("wasGeneratedBy", ("entity", "activity")),
                       ("wasAssociatedWith", ("activity", "agent"))):
    check(prov[relation], f"PROV-JSON: no {relation}")
    for link in prov[relation].values():
        for end in ends:
            check(link["prov:" + end] in prov[end], f"PROV-JSON: {relation} of {link}")

# Another program's reading of the same file: what it understands must be all that was written, and
# what it writes back must be the same document.
document = ProvDocument.deserialize(source=sys.argv[2], format="json")
for kind, record in (("entity", ProvEntity), ("activity", ProvActivity), ("agent", ProvAgent),
                     ("used", ProvUsage), ("wasGeneratedBy", ProvGeneration),
                     ("wasAssociatedWith", ProvAssociation)):
    understood = len(list(document.get_records(record)))
    check(understood == len(prov[kind]),
          f"PROV-JSON: python's prov reads {understood} of {len(prov[kind])} under {kind}")
for activity in document.get_records(ProvActivity):
    start, end = activity.get_startTime(), activity.get_endTime()
    check(start is None or end is None or start <= end, f"PROV-JSON: {activity} ends before it starts")
again = ProvDocument.deserialize(content=document.serialize(format="json"), format="json")
check(again == document, "PROV-JSON: changed by python's prov")

for fault in faults[:40]:
    print(fault)
sys.exit(1 if faults else 0)
