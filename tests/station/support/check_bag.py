#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright The Dubsar developers
"""check_bag.py FOLDER: holds a bag against RFC 8493, section by section. Shares nothing with the program that wrote it.

Prints what is wrong, one line each; exit status 1 then. Stricter than the standard: links, a byte order mark and an
unknown tag in bagit.txt are faults.
"""
import hashlib
import re
import sys
from pathlib import Path

DIGITS = {name: 2 * hashlib.new(name).digest_size for name in ("md5", "sha1", "sha256", "sha512")}
faults = []


def fault(what):
    faults.append(what)
    return None


def text_of(path):
    """A tag file: UTF-8 without a byte order mark (2.1.1, 2.2.4), each line ended."""
    raw = path.read_bytes()
    if raw.startswith(b"\xef\xbb\xbf"):
        fault(f"{path.name}: begins with a byte order mark")
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError as error:
        return fault(f"{path.name}: {error}") or ""


def lines_of(path):
    return re.split("\r\n|\r|\n", text_of(path).rstrip("\r\n"))


def check_declaration(bag):  # 2.1.1
    if lines_of(bag / "bagit.txt") != ["BagIt-Version: 1.0", "Tag-File-Character-Encoding: UTF-8"]:
        fault("bagit.txt: is not the declaration of version 1.0 in UTF-8")


def manifest(bag, path):  # 2.1.3, 2.2.1
    algorithm = path.stem.split("-", 1)[1]
    sums = {}
    for line in lines_of(path):
        match = re.fullmatch(r"([0-9A-Fa-f]+)[ \t]+\*?(.+)", line)
        if not match or len(match[1]) != DIGITS.get(algorithm):
            fault(f"{path.name}: no {algorithm} checksum and name: {line[:60]!r}")
            continue
        if re.search("%(?!25|0[AaDd])", match[2]):
            fault(f"{path.name}: a percent sign that is not encoded: {match[2]}")
        name = re.sub("%(25|0[AaDd])", lambda m: chr(int(m[1], 16)), match[2])
        if name.startswith(("/", "~")) or ".." in name.split("/") or "\\" in name:
            fault(f"{path.name}: a name that leads out of the bag: {name}")
            continue
        if name in sums:
            fault(f"{path.name}: {name} stands there twice")
        sums[name] = match[1].lower()
        if not (bag / name).is_file():
            fault(f"{path.name}: {name} is not there")
        elif hashlib.new(algorithm, (bag / name).read_bytes()).hexdigest() != sums[name]:
            fault(f"{path.name}: {name} is not what was packed")
    return sums


def check_information(bag, payload):  # 2.2.2
    path = bag / "bag-info.txt"
    if not path.exists():
        return
    tags = []
    for line in lines_of(path):
        match = re.fullmatch(r"([^:\s][^:]*):[ \t](.*)", line)
        if match:
            tags.append((match[1], match[2]))
        elif not (tags and re.match("[ \t]", line)):
            fault(f"bag-info.txt: no label and value: {line[:60]!r}")
    values = dict(tags)
    for once in ("Payload-Oxum", "Bagging-Date", "Bag-Size"):
        if sum(label == once for label, _ in tags) > 1:
            fault(f"bag-info.txt: {once} stands there twice")
    oxum = f"{sum(file.stat().st_size for file in payload)}.{len(payload)}"
    if values.get("Payload-Oxum", oxum) != oxum:
        fault(f"bag-info.txt: Payload-Oxum is {values['Payload-Oxum']}, there are {oxum}")
    if not re.fullmatch(r"\d{4}-\d\d-\d\d", values.get("Bagging-Date", "2000-01-01")):
        fault(f"bag-info.txt: Bagging-Date is no date: {values['Bagging-Date']}")


def check(bag):
    everything = sorted(bag.rglob("*"))
    for path in everything:
        if path.is_symlink() or not (path.is_file() or path.is_dir()):
            fault(f"{path.relative_to(bag)}: neither a file nor a folder")
    if not (bag / "bagit.txt").is_file() or not (bag / "data").is_dir():
        return fault("there is no bagit.txt, or no folder data")
    check_declaration(bag)
    payload = [path for path in everything if path.is_file() and path.relative_to(bag).parts[0] == "data"]
    names = {str(path.relative_to(bag)) for path in payload}
    payload_manifests = sorted(bag.glob("manifest-*.txt"))
    if not payload_manifests:
        fault("there is no payload manifest")
    for path in payload_manifests:  # 3: each names the whole payload and nothing else
        listed = set(manifest(bag, path))
        for name in sorted(names ^ listed):
            fault(f"{path.name}: {name} is " + ("not listed" if name in names else "no payload"))
    tags = {str(p.relative_to(bag)) for p in everything if p.is_file()} - names
    for path in sorted(bag.glob("tagmanifest-*.txt")):
        listed = set(manifest(bag, path))
        if any(name.startswith(("data/", "tagmanifest-")) for name in listed):
            fault(f"{path.name}: lists payload, or a tag manifest")
        for name in sorted(tags - listed):
            if not name.startswith("tagmanifest-"):
                fault(f"{path.name}: {name} is not listed")
    check_information(bag, payload)
    if (bag / "fetch.txt").exists():
        fault("fetch.txt: a package of this program is complete")
    return None


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: check_bag.py FOLDER")
    check(Path(sys.argv[1]))
    for one in faults:
        print(one)
    sys.exit(1 if faults else 0)
